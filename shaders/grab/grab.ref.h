// Twin of grab: a spring with damping and a limited force, in implicit Euler, on one particle.
#pragma once

#include <algorithm>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

struct Pull {
  double stiffness, damping, force;   // N/m, N s/m, N at most
  Vector target, velocity;            // m, at the substep's end; m/s
};

struct PulledParticle {
  Vector velocity;   // m/s
  double mass;       // kg: what the solve takes it to weigh
};

/// A particle at x with the velocity v, in which this substep's gravity is, and the mass that other hands have made of it.
inline PulledParticle pulled(const Pull& pull, const Vector& x, const Vector& v, double mass, double h) {
  const Vector force = pull.stiffness * (pull.target - x - h * v) + pull.damping * (pull.velocity - v);
  const double part = std::min(1.0, pull.force / std::max(force.norm(), 1e-300));
  const double heavier = mass + part * h * (pull.damping + h * pull.stiffness);
  return {v + h * part / heavier * force, heavier};
}

}  // namespace weft::reference
