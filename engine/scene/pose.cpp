// Poses between keys.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/scene.h"

namespace weft {

namespace {

constexpr double kDegree = std::numbers::pi / 180;

Eigen::Quaterniond rotation_of(const Key& key) {
  const Eigen::Vector3d axis(key.axis.x, key.axis.y, key.axis.z);
  if (axis.squaredNorm() == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(key.degrees * kDegree, axis.normalized()));
}

float mixed(float a, float b, double t) { return static_cast<float>(a + t * (static_cast<double>(b) - a)); }

Rotation narrowed(const Eigen::Quaterniond& q) {
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()), static_cast<float>(q.w())};
}

Eigen::Quaterniond widened(const Rotation& r) { return Eigen::Quaterniond(r.w, r.x, r.y, r.z); }

}  // namespace

Rotation rotation_about(Vec3 axis, double degrees) { return narrowed(rotation_of({0, {}, axis, degrees})); }

Rotation rest_rotation(const Collider& collider) {
  if (collider.shape == ColliderShape::box || collider.shape == ColliderShape::mesh) return rotation_about(collider.axis, collider.degrees);
  if (collider.shape != ColliderShape::capsule) return {};
  return narrowed(
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), Eigen::Vector3d(collider.axis.x, collider.axis.y, collider.axis.z)));
}

Rotation operator*(const Rotation& a, const Rotation& b) { return narrowed((widened(a) * widened(b)).normalized()); }

Vec3 rotated(const Rotation& rotation, Vec3 v) {
  const Eigen::Vector3d turned = widened(rotation) * Eigen::Vector3d(v.x, v.y, v.z);
  return {static_cast<float>(turned.x()), static_cast<float>(turned.y()), static_cast<float>(turned.z())};
}

Key pose_at(std::span<const Key> keys, double time) {
  Key pose;
  pose.time = time;
  if (keys.empty()) return pose;
  const auto next = std::upper_bound(keys.begin(), keys.end(), time, [](double at, const Key& key) { return at < key.time; });
  if (next == keys.begin() || next == keys.end()) {
    pose = next == keys.begin() ? keys.front() : keys.back();
    pose.time = time;
    return pose;
  }
  const Key &from = *(next - 1), &to = *next;
  const double t = (time - from.time) / (to.time - from.time);
  pose.translate = {mixed(from.translate.x, to.translate.x, t), mixed(from.translate.y, to.translate.y, t),
                    mixed(from.translate.z, to.translate.z, t)};

  // A key that does not turn has no axis of its own; one that turns about the opposite axis turns the other way.
  const Vec3 axis = from.degrees != 0 ? from.axis : to.axis;
  const bool same = to.degrees == 0 || to.axis == axis;
  const bool opposite = !same && to.axis == -1.0f * axis;
  if (same || opposite) {
    pose.axis = axis;
    pose.degrees = from.degrees + t * ((opposite ? -to.degrees : to.degrees) - from.degrees);
    return pose;
  }
  // Eigen's slerp takes the shorter way round and falls back to a line where the arc vanishes.
  const Eigen::AngleAxisd turned(rotation_of(from).slerp(t, rotation_of(to)));
  pose.axis = {static_cast<float>(turned.axis().x()), static_cast<float>(turned.axis().y()), static_cast<float>(turned.axis().z())};
  pose.degrees = turned.angle() / kDegree;
  return pose;
}

}  // namespace weft
