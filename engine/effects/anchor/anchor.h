// Kinematic particles (inverse mass 0): anchors, which keys or the host drive, and the vertices of mesh colliders.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

/// Every kinematic particle, at rest at its cooked position: all anchors, empty places for so many pins, then the particles of mesh colliders.
std::vector<gpu::Anchor> anchors_at_rest(const CookedFabric& fabric, std::uint32_t pins);

namespace lengths {
inline std::uint64_t anchors(const Cooked& s) { return kinematic_particles(s.fabric) + s.scene.pins; }
}  // namespace lengths

namespace buffers {
/// Each kinematic particle's position at the frame's start and its target at the frame's end (m).
inline constexpr Buffer anchors =
    buffer<gpu::Anchor>("anchors", Lifetime::uploaded, lengths::anchors,
                        [](const Cooked& s) { return made(anchors_at_rest(s.fabric, s.scene.pins)); });
}  // namespace buffers
}  // namespace weft
