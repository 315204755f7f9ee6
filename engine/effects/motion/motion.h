// Particles: where they are, how fast they move, and where an iteration has taken them.
//
// An iterate's w is what a particle takes of the sum over its constraints (stretch/stretch.comp). `predicted` is the iterate at hand and
// `relaxed` the next one; a pass that changes iterates writes the second, and the two trade places after it (Changes::iterate).
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

/// The iterates that cooked positions start from.
std::vector<gpu::vec4> iterates_at(const std::vector<gpu::vec4>& positions, const CookedFabric& fabric);

namespace buffers {
namespace detail {
inline Contents first_iterate(const Cooked& s) { return made(iterates_at(s.fabric.positions, s.fabric)); }
}  // namespace detail

/// xyz position at the substep's start (m), w inverse mass (1/kg).
inline constexpr Buffer positions = buffer<gpu::vec4>("positions", Lifetime::kept, lengths::particles, [](const Cooked& s) { return lying(s.fabric.positions); });
/// xyz velocity that `predicted` was made with (m/s), w material index as bits.
inline constexpr Buffer velocities = buffer<gpu::vec4>("velocities", Lifetime::kept, lengths::particles, [](const Cooked& s) { return lying(s.fabric.velocities); });
/// xyz current iterate (m), w its share of a sum. Between frames where the particles are: what no frame predicts (anchors) it finds there.
inline constexpr Buffer predicted = buffer<gpu::vec4>("predicted", Lifetime::scratch, lengths::particles, detail::first_iterate);
inline constexpr Buffer relaxed = buffer<gpu::vec4>("relaxed", Lifetime::scratch, lengths::particles, detail::first_iterate);
/// Material, per cloth and then per mesh collider.
inline constexpr Buffer materials = cooked<gpu::vec4, &CookedFabric::materials>("materials");
/// What was mended while running.
inline constexpr Buffer counters = buffer<gpu::Counters>("counters", Lifetime::kept, lengths::one);
}  // namespace buffers
}  // namespace weft
