// Twin of skin in double precision.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>

#include "shaders/jacobi.ref.h"

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

}  // namespace weft::reference
