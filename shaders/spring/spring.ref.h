// Twin of spring: symplectic Euler on springs with damping along them (Provot 1995).
#pragma once

#include "shaders/stretch/stretch.ref.h"

namespace weft::reference {

struct DampedSpring {
  std::uint32_t a, b;
  double rest;         // m
  double stiffness;    // N/m
  double damping;      // N s/m
  bool only_pulls;
};

/// The force (N) of a spring on its end a; on b it is the opposite. Ends at one place have no velocity along it.
inline Vector spring_force(const DampedSpring& spring, const Vector& a, const Vector& b, const Vector& velocity_a,
                           const Vector& velocity_b) {
  const Vector d = a - b;
  const double length = d.norm();
  if (spring.only_pulls && length < spring.rest) return Vector::Zero();
  if (length <= kCoincident) return (spring.a < spring.b ? 1 : -1) * spring.stiffness * spring.rest * apart();
  const Vector along = d / length;
  return -(spring.stiffness * (length - spring.rest) + spring.damping * (velocity_a - velocity_b).dot(along)) * along;
}

/// Predictions `p` (from positions x with velocities v) after the impulses of all springs.
inline Points push_springs(std::span<const DampedSpring> springs, Points p, const Points& x, const Points& v,
                           std::span<const double> inverse_masses, double h) {
  for (const DampedSpring& spring : springs) {
    const Vector force = spring_force(spring, x[spring.a], x[spring.b], v[spring.a], v[spring.b]);
    p[spring.a] += h * h * inverse_masses[spring.a] * force;
    p[spring.b] -= h * h * inverse_masses[spring.b] * force;
  }
  return p;
}

}  // namespace weft::reference
