// Particles: positions, velocities, and the iterates of the solve.
//
// An iterate's w is the weight of the sum over the particle's constraints in its correction (stretch/stretch.comp).
// `predicted` is the iterate at hand and `next_iterate` the next one; a pass that changes iterates writes the second, and the
// two trade places after it (Changes::iterate).
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

/// The first iterates, for given positions.
std::vector<gpu::vec4> iterates_at(const std::vector<gpu::vec4>& positions, const CookedFabric& fabric);

namespace buffers {
namespace detail {
inline Contents first_iterate(const Cooked& s) { return made(iterates_at(s.fabric.positions, s.fabric)); }
}  // namespace detail

/// xyz position at the substep's start (m), w inverse mass (1/kg).
inline constexpr Buffer positions =
    buffer<gpu::vec4>("positions", Lifetime::persistent, lengths::particles, [](const Cooked& s) { return lying(s.fabric.positions); });
/// xyz velocity that `predicted` was made with (m/s), w material index as bits.
inline constexpr Buffer velocities =
    buffer<gpu::vec4>("velocities", Lifetime::persistent, lengths::particles, [](const Cooked& s) { return lying(s.fabric.velocities); });
/// xyz current iterate (m), w the weight of the sum. Between frames xyz is the position: anchors, which no pass predicts, are
/// read there.
inline constexpr Buffer predicted = buffer<gpu::vec4>("predicted", Lifetime::scratch, lengths::particles, detail::first_iterate);
inline constexpr Buffer next_iterate = buffer<gpu::vec4>("next_iterate", Lifetime::scratch, lengths::particles, detail::first_iterate);
/// gpu::Material of each cloth, then of each mesh collider.
inline constexpr Buffer materials = cooked<gpu::vec4, &CookedFabric::materials>("materials");
/// Counts of what was sanitized, truncated or not converged, and the largest tracking error.
inline constexpr Buffer counters = buffer<gpu::Counters>("counters", Lifetime::persistent, lengths::one);
}  // namespace buffers
}  // namespace weft
