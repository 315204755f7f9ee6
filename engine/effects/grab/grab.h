// Grabs: hands that pull places of cloth to targets which the host moves.
#pragma once

#include "engine/effects/buffer.h"

namespace weft::buffers {

/// Of each grab the three corners of its triangle.
inline constexpr Buffer grabs = buffer<gpu::Grab>(
    "grabs", Lifetime::uploaded, [](const Cooked& s) { return std::uint64_t(3 * s.scene.grabs); },
    [](const Cooked& s) { return made(std::vector<gpu::Grab>(3 * s.scene.grabs, {WEFT_NONE, 0, 0, 0, 0, {}, {}})); });

}  // namespace weft::buffers
