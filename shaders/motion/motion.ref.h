// Twin of predict and of the velocity update in finalize: symplectic Euler around a position-based solve
// (Mueller, Heidelberger, Hennix, Ratcliff 2007, "Position based dynamics", algorithm 1).
#pragma once

#include <cmath>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

struct Motion {
  Vector position;   // m
  Vector velocity;   // m/s
};

/// v <- exp(-damping h) (v + h g), p = x + h v; a kinematic particle (`held`) stays. The damping is viscous drag,
/// dv/dt = -damping v, solved exactly.
inline Motion predict(const Motion& now, const Vector& gravity, double damping, double h, bool held) {
  if (held) return {now.position, Vector::Zero()};
  const Vector velocity = std::exp(-damping * h) * (now.velocity + h * gravity);
  return {now.position + h * velocity, velocity};
}

/// v = (p - x) / h.
inline Vector velocity(const Vector& from, const Vector& to, double h) { return (to - from) / h; }

}  // namespace weft::reference
