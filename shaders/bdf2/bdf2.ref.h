// Twin of bdf2/bdf2.glsl: the backward differentiation formula of two steps, from both states before, not from their differences.
#pragma once

#include "shaders/motion/motion.ref.h"

namespace weft::reference {

/// The free motion of a substep: (4 now - before) / 3 + 2/3 h times its derivative at the end, of velocity and of position. The damping is
/// viscous drag, dv/dt = -damping v, in the formula too.
inline Motion predict_bdf2(const Motion& before, const Motion& now, const Vector& gravity, double damping, double h) {
  const Vector velocity = ((4 * now.velocity - before.velocity) / 3 + 2 * h / 3 * gravity) / (1 + 2 * h / 3 * damping);
  return {(4 * now.position - before.position) / 3 + 2 * h / 3 * velocity, velocity};
}

/// The velocity with which a substep ends that led to `next`.
inline Vector velocity_bdf2(const Vector& before, const Vector& now, const Vector& next, double h) {
  return (3 * next - 4 * now + before) / (2 * h);
}

}  // namespace weft::reference
