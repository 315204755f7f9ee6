// Second order in time: what a substep keeps of the one before (shaders/bdf2/bdf2.glsl).
#pragma once

#include "engine/effects/buffer.h"

namespace weft::buffers {
namespace detail {

// As if all had been in free fall: what begins at rest then follows the parabola from its first substep on.
inline std::vector<gpu::vec4> in_fall(const Cooked& s, double part) {
  const double h = s.fabric.h;
  const auto of = [&](float g) { return static_cast<float>(part * h * g); };
  const gpu::vec4 fall{of(s.scene.gravity.x), of(s.scene.gravity.y), of(s.scene.gravity.z), 0};
  return std::vector<gpu::vec4>(s.fabric.positions.size(), fall);
}

}  // namespace detail

/// xyz by how much the last substep changed the velocity, but for colliders' pushes (m/s).
inline constexpr Buffer velocity_changes = buffer<gpu::vec4>("velocity_changes", Lifetime::persistent, lengths::particles,
                                                             [](const Cooked& s) { return made(detail::in_fall(s, 1)); });
/// xyz what the last substep went besides h times the velocity that it ended with (m).
inline constexpr Buffer step_remainders = buffer<gpu::vec4>("step_remainders", Lifetime::persistent, lengths::particles,
                                                            [](const Cooked& s) { return made(detail::in_fall(s, -0.5 * s.fabric.h)); });
/// xyz velocity when the substep begins (m/s).
inline constexpr Buffer velocities_before = scratch<gpu::vec4>("velocities_before", lengths::particles);

}  // namespace weft::buffers
