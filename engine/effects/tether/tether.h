// Tethers: no particle farther from its anchors than along the cloth (long-range attachment, Kim et al. 2012).
#pragma once

#include "engine/effects/buffer.h"

namespace weft::buffers {

/// Of each particle in turn, two a fetch: (anchor, reach as float bits), nearest first.
inline constexpr Buffer tethers = cooked<gpu::uvec4, &CookedFabric::tethers>("tethers");

}  // namespace weft::buffers
