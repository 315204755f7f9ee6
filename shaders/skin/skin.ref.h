// Twin of skin in double precision.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>

#include "shaders/jacobi.ref.h"
#include "shaders/shared.h"

namespace weft::reference {

/// Where morph targets have a point, or its normal: each adds its delta, times its weight.
inline Vector morphed(Vector rest, std::span<const Vector> deltas, std::span<const double> weights) {
  for (std::size_t m = 0; m < deltas.size(); ++m) rest += weights[m] * deltas[m];
  return rest;
}

/// Where joints take a point: the mean of their maps, by its weights.
inline Eigen::Affine3d blend(std::span<const Eigen::Affine3d> joints, const std::array<std::uint32_t, 4>& of, const std::array<double, 4>& weights) {
  Eigen::Affine3d mean;
  mean.matrix().setZero();
  for (std::size_t k = 0; k < 4; ++k) mean.matrix() += weights[k] * joints[of[k]].matrix();
  mean.matrix().row(3) << 0, 0, 0, 1;
  return mean;
}

/// Where a point is when a frame begins and when it ends, and its normals.
struct Ends {
  Vector x_from, x_to, normal_from, normal_to;
};

/// What the host says of a point: a place, and a normal, that may not be finite.
struct HostTarget {
  Vector x, normal;
};

/// `ends` by joints, `kept` of the last frame (of its place and its normal), and by what source they are (WEFT_FROM_KEPT and the like).
inline Ends with_host_targets(Ends ends, const HostTarget& kept, const HostTarget& told, std::uint32_t source) {
  const auto is_sound = [](const Vector& v) { return v.allFinite() && v.norm() < 1e10; };
  if ((source & WEFT_FROM_KEPT) != 0) ends.x_from = kept.x, ends.normal_from = kept.normal;
  if ((source & WEFT_TO_KEPT) != 0) ends.x_to = ends.x_from, ends.normal_to = ends.normal_from;
  if ((source & WEFT_TO_HOST) == 0) return ends;
  ends.x_to = is_sound(told.x) ? told.x : ends.x_from;
  if ((source & WEFT_HOST_NORMALS) != 0)
    ends.normal_to = is_sound(told.normal) && told.normal.norm() > 1e-12 ? Vector(told.normal.normalized()) : ends.normal_from;
  return ends;
}

}  // namespace weft::reference
