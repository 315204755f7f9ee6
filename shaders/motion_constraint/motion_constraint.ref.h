// Twin of motion_constraint.glsl in double precision.
#pragma once

#include <algorithm>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

struct MotionConstraint {
  Vector place, stop;                // m: the animated place, and the middle of its backstop
  double max_distance = 0, stiffness = 1, radius = 0;
};

inline Vector within_motion_constraint(const MotionConstraint& c, Vector p) {
  if (const double behind = c.radius - (p - c.stop).norm(); behind > 0 && behind < c.radius) p += behind * (p - c.stop).normalized();
  const double beyond = std::max(0.0, (p - c.place).norm() - c.max_distance);
  return beyond > 0 ? Vector(p - c.stiffness * beyond * (p - c.place).normalized()) : p;
}

}  // namespace weft::reference
