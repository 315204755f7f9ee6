// Grabs: hands that pull places of cloth to targets which the host moves.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

inline std::vector<gpu::LastPull> no_pulls(const Scene& scene) {
  return std::vector<gpu::LastPull>(3 * scene.grabs, gpu::LastPull{WEFT_NONE, 0, 0, {}, {}, {}, {}});
}

}  // namespace weft

namespace weft::buffers {

/// Of each grab the three corners of its triangle.
inline constexpr Buffer grabs = buffer<gpu::Grab>(
    "grabs", Lifetime::uploaded, [](const Cooked& s) { return std::uint64_t(3 * s.scene.grabs); },
    [](const Cooked& s) { return made(std::vector<gpu::Grab>(3 * s.scene.grabs, {WEFT_NONE, 0, 0, 0, 0, {}, {}})); });

/// Of each corner, with reactions: how it was pulled in the last substep.
inline constexpr Buffer last_pulls =
    buffer<gpu::LastPull>("last_pulls", Lifetime::persistent, [](const Cooked& s) { return std::uint64_t(3 * s.scene.grabs); },
                          [](const Cooked& s) { return made(no_pulls(s.scene)); });

}  // namespace weft::buffers
