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

}  // namespace

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
