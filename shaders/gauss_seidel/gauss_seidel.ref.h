// Twin of turn.glsl: the angular momentum of a patch after a sweep through its links (gauss_seidel.comp; stretch.ref.h has the sweep).
#pragma once

#include <Eigen/LU>

#include <span>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// What moving particles from `before` to `after` in a substep that began at `x` changes their angular momentum by, times the substep
/// (kg m^2): the sum of m x cross (after - before).
inline Vector turned_by(std::span<const std::uint32_t> members, const Points& x, const Points& before, const Points& after,
                        std::span<const double> inverse_masses) {
  Vector sum = Vector::Zero();
  for (const std::uint32_t i : members) sum += (x[i] - x[members[0]]).cross(after[i] - before[i]) / inverse_masses[i];
  return sum;
}

/// Turns particles, none of them held, so that they have the angular momentum again that they had.
inline void turn_back(std::span<const std::uint32_t> members, const Points& x, const Points& before, Points& after,
                      std::span<const double> inverse_masses) {
  Vector centre = Vector::Zero();
  double mass = 0;
  for (const std::uint32_t i : members) {
    if (inverse_masses[i] == 0) return;
    centre += x[i] / inverse_masses[i];
    mass += 1 / inverse_masses[i];
  }
  centre /= mass;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (const std::uint32_t i : members) {
    const Vector r = x[i] - centre;
    inertia += (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose()) / inverse_masses[i];
  }
  inertia.diagonal().array() += 1e-5 * inertia.trace();
  const Vector angle = -inertia.inverse() * turned_by(members, x, before, after, inverse_masses);
  if (!(angle.squaredNorm() < 0.01)) return;
  for (const std::uint32_t i : members) after[i] += angle.cross(x[i] - centre);
}

}  // namespace weft::reference
