// Skins made in code.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "engine/mesh.h"

namespace weft {

inline Affine narrowed(const Eigen::Affine3d& m) {
  const auto column = [&](int k) {
    return Vec3{static_cast<float>(m.matrix()(0, k)), static_cast<float>(m.matrix()(1, k)), static_cast<float>(m.matrix()(2, k))};
  };
  return {column(0), column(1), column(2), column(3)};
}
inline Eigen::Affine3d widened(const Affine& m) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  int k = 0;
  for (const Vec3& column : {m.x, m.y, m.z, m.origin}) result.matrix().block<3, 1>(0, k++) = Eigen::Vector3d(column.x, column.y, column.z);
  return result;
}

inline Affine moved_by(Vec3 way) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, way}; }

/// Two joints: the mesh's points belong to the first at low x, to the second at high x, and evenly to both between.
inline Skin two_joints(const Mesh& mesh) {
  Skin skin;
  skin.nodes.resize(2);
  skin.joints = {{"low", 0, {}}, {"high", 1, {}}};
  float low = 1e9f, high = -1e9f;
  for (const Vec3& p : mesh.points) low = std::min(low, p.x), high = std::max(high, p.x);
  for (const Vec3& p : mesh.points) {
    const float t = (p.x - low) / (high - low);
    skin.joints_of.push_back({0, 1, 0, 0});
    skin.weights.push_back({1 - t, t, 0, 0});
  }
  return skin;
}

}  // namespace weft
