// Twin of reaction.glsl: the momentum that a collider is given, the opposite of a particle's.
#pragma once

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// kg m/s, and kg m^2/s about a centre.
struct Momentum {
  Vector linear = Vector::Zero(), angular = Vector::Zero();
  Momentum& operator+=(const Momentum& more) {
    linear += more.linear;
    angular += more.angular;
    return *this;
  }
};

/// Of a collider with its centre there, which has moved a particle of mass 1 / w from `before` to `after` in a substep of h seconds.
inline Momentum reaction(const Vector& centre, const Vector& before, const Vector& after, double w, double h) {
  if (w == 0) return {};
  const Vector impulse = -(after - before) / (w * h);
  return {impulse, (after - centre).cross(impulse)};
}

}  // namespace weft::reference
