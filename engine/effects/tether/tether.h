// Tethers (long range attachments, Kim et al. 2012): no particle is farther from its anchors than along the cloth.
#pragma once

#include "engine/effects/buffer.h"

namespace weft::buffers {

/// Of each particle in turn, two a fetch, nearest first: (anchor, max distance (m) as float bits).
inline constexpr Buffer tethers = cooked<gpu::uvec4, &CookedFabric::tethers>("tethers");

}  // namespace weft::buffers
