// Anchors: particles that keys or the host lead, the vertices of mesh colliders among them.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

/// Every particle that is led, where it is at rest: all anchors, then the particles of mesh colliders.
std::vector<gpu::Anchor> anchors_at_rest(const CookedFabric& fabric);

namespace lengths {
inline std::uint64_t anchors(const Cooked& s) { return moved_particles(s.fabric); }
}  // namespace lengths

namespace buffers {
/// Where they are led in this frame.
inline constexpr Buffer anchors =
    buffer<gpu::Anchor>("anchors", Lifetime::told, lengths::anchors, [](const Cooked& s) { return made(anchors_at_rest(s.fabric)); });
}  // namespace buffers
}  // namespace weft
