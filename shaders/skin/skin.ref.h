// Twin of skin in double precision.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// Where joints take a point: the mean of their maps, by its weights.
inline Eigen::Affine3d blend(std::span<const Eigen::Affine3d> joints, const std::array<std::uint32_t, 4>& of, const std::array<double, 4>& weights) {
  Eigen::Affine3d mean;
  mean.matrix().setZero();
  for (std::size_t k = 0; k < 4; ++k) mean.matrix() += weights[k] * joints[of[k]].matrix();
  mean.matrix().row(3) << 0, 0, 0, 1;
  return mean;
}

}  // namespace weft::reference
