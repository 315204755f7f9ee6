#include "engine/shading/view.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft::shading {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

Vector3d vector(Vec3 v) { return {v.x, v.y, v.z}; }

void store(mat4& to, const Matrix4d& from) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) to[static_cast<std::size_t>(4 * column + row)] = static_cast<float>(from(row, column));
}

// Rows: right, up, forward. Straight up or down, "up" is taken along -z.
Matrix3d looking_along(const Vector3d& direction) {
  const Vector3d forward = direction.norm() > 0 ? direction.normalized() : Vector3d(0, 0, -1);
  const Vector3d world_up = std::abs(forward.y()) > 0.999 ? Vector3d(0, 0, -1) : Vector3d(0, 1, 0);
  const Vector3d right = forward.cross(world_up).normalized();
  Matrix3d axes;
  axes << right.transpose(), right.cross(forward).transpose(), forward.transpose();
  return axes;
}

}  // namespace

void set_camera(Frame& frame, const Camera& camera, std::uint32_t width, std::uint32_t height) {
  const Vector3d eye = vector(camera.eye), ahead = vector(camera.target) - eye;
  const Matrix3d axes = looking_along(ahead);
  const double half_height = std::tan(0.5 * camera.fov_degrees * std::numbers::pi / 180);
  const double half_width = half_height * width / height;
  const double near_plane = std::clamp(0.01 * ahead.norm(), 1e-4, 0.05);

  // clip = (right / half_width, -up / half_height, near, forward) of (p - eye): y runs downward in Vulkan.
  Matrix4d clip = Matrix4d::Zero();
  clip.block<1, 3>(0, 0) = axes.row(0) / half_width;
  clip.block<1, 3>(1, 0) = -axes.row(1) / half_height;
  clip.block<1, 3>(3, 0) = axes.row(2);
  clip.col(3) = -clip.leftCols<3>() * eye;
  clip(2, 3) = near_plane;
  store(frame.camera, clip);

  const auto ray = [](const Vector3d& v) {
    return vec4{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
  };
  frame.ray_x = ray(half_width * axes.row(0).transpose());
  frame.ray_y = ray(-half_height * axes.row(1).transpose());
  frame.ray_z = ray(axes.row(2).transpose());
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  frame.size = {w, h, 1 / w, 1 / h};
  frame.eye = camera.eye;
  frame.near_plane = static_cast<float>(near_plane);
}

void set_sun(Frame& frame, const Extent& extent, std::uint32_t texels) {
  const Vector3d centre = vector(extent.centre);
  const double radius = extent.radius;
  const Matrix3d axes = looking_along(-vector(frame.to_sun));
  // What casts shadows begins `radius` before the centre; what they fall on may lie far behind it.
  const double depth = 8 * radius;
  Matrix4d clip = Matrix4d::Zero();
  clip.block<1, 3>(0, 0) = axes.row(0) / radius;
  clip.block<1, 3>(1, 0) = -axes.row(1) / radius;
  clip.block<1, 3>(2, 0) = axes.row(2) / depth;
  clip.col(3) = -clip.leftCols<3>() * centre;
  clip(2, 3) += 1.2 * radius / depth;
  clip(3, 3) = 1;
  store(frame.sun, clip);
  frame.sun_texel = static_cast<float>(2 * radius / texels);
  frame.sun_depth = static_cast<float>(depth);
}

}  // namespace weft::shading
