// What colliders hold weighs more against them in the solve (shaders/support/support.glsl).
#pragma once

#include "engine/effects/buffer.h"
#include "engine/effects/level/level.h"

namespace weft {

struct SupportLists {
  bool holds = false;   // some collider carries cloth by little of it: a box, by its edges, one that is thin for it, or may become so
};

namespace buffers {

/// xyz: how far colliders have put each particle out in the last substeps, a running mean; w: what of its steps into them the solve
/// has held back since (m).
inline constexpr Buffer supports = buffer<gpu::vec4>("supports", Lifetime::persistent, lengths::particles);

/// With reactions: the collider that has put each particle out last.
inline constexpr Buffer support_bodies = buffer<gpu::uint>("support_bodies", Lifetime::persistent, lengths::particles);

/// Of each node of coarse levels, the mean of xyz over what it carries (m).
inline constexpr Buffer level_supports =
    scratch<gpu::vec4>("level_supports", [](const Cooked& s) { return std::uint64_t(s.fabric.own.of<LevelLists>().nodes.size()); });

}  // namespace buffers
}  // namespace weft
