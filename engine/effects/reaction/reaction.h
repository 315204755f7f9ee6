// Reactions: the impulses of cloth on colliders, and on hands. Sums of integers, so that they do not depend on the order of threads, and
// never emptied: what happened between two frames is the difference of their sums, whichever frames in between the host has heard of.
#pragma once

#include "engine/effects/buffer.h"
#include "engine/reaction.h"

namespace weft {

/// The unit of the sums: kg m/s of an impulse, kg m^2/s of an angular one. A power of two, about 2^-40 of the mass of all that moves: what
/// a particle of a cloth of 100,000 loses is told to a thousandth from 0.1 mm/s on, and a frame in which all cloth changes by 4,000 km/s
/// does not overflow.
double reaction_quantum(const CookedFabric& fabric);

/// What happened from one sum to another, in the units above.
Reaction reaction_between(const gpu::Reaction& from, const gpu::Reaction& to, double quantum);

namespace buffers {

/// Of each collider that is a formula, in the order of the buffer `colliders`, of each grab, and of each mesh collider, since the start.
inline constexpr Buffer reactions = buffer<gpu::Reaction>("reactions", Lifetime::persistent, [](const Cooked& s) {
  return std::uint64_t(s.scene.colliders.size() + s.scene.grabs);
});

}  // namespace buffers
}  // namespace weft
