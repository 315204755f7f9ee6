// See samples/godot/poses.h.
#include "samples/godot/poses.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace weft_godot {
namespace {

using weft::Key;
using weft::Rotation;
using weft::Vec3;

constexpr double kDegree = std::numbers::pi / 180;

Eigen::Matrix3d matrix(const godot::Transform& t) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = t.rows[i][j];
  return m;
}

godot::Transform transform(const Eigen::Matrix3d& m, const Eigen::Vector3d& origin) {
  godot::Transform t;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t.rows[i][j] = static_cast<float>(m(i, j));
  t.origin = {static_cast<float>(origin.x()), static_cast<float>(origin.y()), static_cast<float>(origin.z())};
  return t;
}

Eigen::Vector3d wide(Vec3 v) { return {v.x, v.y, v.z}; }

// As a scene's reader makes a direction of length 1, until that changes nothing.
Vec3 unit(Vec3 axis) {
  for (int k = 0; k < 8; ++k) {
    const double scale = 1 / std::hypot(double(axis.x), double(axis.y), double(axis.z));
    const Vec3 next{static_cast<float>(axis.x * scale), static_cast<float>(axis.y * scale), static_cast<float>(axis.z * scale)};
    if (next == axis) break;
    axis = next;
  }
  return axis;
}

// Whether making it of length 1 changes nothing.
bool is_kept(const Rotation& r) { return r * Rotation{} == r; }

}  // namespace

std::optional<Placed> placed(const godot::Transform& t) {
  const Eigen::Matrix3d m = matrix(t);
  const Eigen::Vector3d size(m.col(0).norm(), m.col(1).norm(), m.col(2).norm());
  if (!(size.minCoeff() > 1e-9) || !std::isfinite(size.maxCoeff()) || !std::isfinite(t.origin.x + t.origin.y + t.origin.z)) return {};
  Eigen::Matrix3d turn = m;
  for (int k = 0; k < 3; ++k) turn.col(k) /= size[k];
  if (turn.determinant() < 0.99) return {};
  const Eigen::Quaterniond q = Eigen::Quaterniond(turn).normalized();
  return Placed{t.origin,
                {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()), static_cast<float>(q.w())},
                {static_cast<float>(size.x()), static_cast<float>(size.y()), static_cast<float>(size.z())}};
}

bool is_even(Vec3 scale) {
  const float low = std::min({scale.x, scale.y, scale.z}), high = std::max({scale.x, scale.y, scale.z});
  return high - low <= 1e-3f * high;
}

Key key_of(Vec3 at, const Rotation& rotation, const Key& before) {
  Key key;
  key.translate = at;
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(rotation.w, rotation.x, rotation.y, rotation.z).normalized());
  if (std::abs(turn.angle()) < 1e-7) {   // about no axis: +y by 0 degrees, or -y
    if (key.axis == before.axis && before.degrees != 0) key.axis = {0, -1, 0};
    return key;
  }
  const Vec3 axis{static_cast<float>(turn.axis().x()), static_cast<float>(turn.axis().y()), static_cast<float>(turn.axis().z())};
  const double degrees = turn.angle() / kDegree;
  constexpr float kStep = 3e-8f;   // half of the step of floats below 1: near half a turn the axis has to give way, too
  for (int k = 0; k < 125 * 40; ++k) {
    const int nudge = k / 40;
    key.axis = unit({axis.x + kStep * float(nudge % 5), axis.y + kStep * float(nudge / 5 % 5), axis.z + kStep * float(nudge / 25)});
    key.degrees = degrees * (1 + 2e-8 * (k % 40)) + 1e-5 * nudge;
    if (unit(key.axis) == key.axis && is_kept(weft::rotation_about(key.axis, key.degrees))) break;
  }
  if (key.axis == before.axis) key.axis = -1.0f * key.axis, key.degrees = -key.degrees;
  return key;
}

godot::Transform operator*(const godot::Transform& a, const godot::Transform& b) {
  const Eigen::Matrix3d m = matrix(a);
  return transform(m * matrix(b), m * wide(b.origin) + wide(a.origin));
}

Vec3 operator*(const godot::Transform& a, Vec3 p) {
  const Eigen::Vector3d to = matrix(a) * wide(p) + wide(a.origin);
  return {static_cast<float>(to.x()), static_cast<float>(to.y()), static_cast<float>(to.z())};
}

std::optional<godot::Transform> inverse(const godot::Transform& t) {
  const Eigen::Matrix3d m = matrix(t);
  if (!(std::abs(m.determinant()) > 1e-12)) return {};
  const Eigen::Matrix3d back = m.inverse();
  return transform(back, -(back * wide(t.origin)));
}

}  // namespace weft_godot
