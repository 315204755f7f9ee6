// See samples/view/orbit.h.
#include "samples/view/orbit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft::view {
namespace {

constexpr double kSteepest = 0.499 * std::numbers::pi;
constexpr double kNearest = 1e-3, kFarthest = 1e4;   // m

double half_height(double fov_degrees) { return std::tan(0.5 * fov_degrees * std::numbers::pi / 180); }

Vec3 scaled(double s, Vec3 v) { return static_cast<float>(s) * v; }

Vec3 unit(Vec3 v) { return scaled(1 / length(v), v); }

struct Axes {
  Vec3 right, up, ahead;   // unit
};

Axes axes_of(const Camera& camera) {
  Axes axes;
  axes.ahead = unit(camera.target - camera.eye);
  const Vec3 across = cross(axes.ahead, std::abs(axes.ahead.y) > 0.999f ? Vec3{0, 0, -1} : Vec3{0, 1, 0});
  axes.right = unit(across);
  axes.up = cross(axes.right, axes.ahead);
  return axes;
}

}  // namespace

Ray ray_through(const Camera& camera, double x, double y, double aspect) {
  const Axes axes = axes_of(camera);
  const double half = half_height(camera.fov_degrees);
  return {camera.eye, unit(axes.ahead + scaled(x * half * aspect, axes.right) - scaled(y * half, axes.up))};
}

Vec3 seen_at(const Camera& camera, Vec3 point, double aspect) {
  const Axes axes = axes_of(camera);
  const Vec3 from = point - camera.eye;
  const double half = half_height(camera.fov_degrees), depth = dot(from, axes.ahead);
  const double scale = 1 / (std::max(depth, 1e-9) * half);
  return {static_cast<float>(dot(from, axes.right) * scale / aspect), static_cast<float>(-dot(from, axes.up) * scale),
          static_cast<float>(depth)};
}

Orbit::Orbit(const Camera& camera) : target_(camera.target), fov_degrees_(camera.fov_degrees) {
  const Vec3 back = camera.eye - camera.target;
  distance_ = std::clamp<double>(length(back), kNearest, kFarthest);
  if (length(back) == 0) return;
  yaw_ = std::atan2(back.x, back.z);
  pitch_ = std::clamp(std::asin(std::clamp<double>(back.y / length(back), -1, 1)), -kSteepest, kSteepest);
}

Camera Orbit::camera() const {
  const Vec3 back{static_cast<float>(std::cos(pitch_) * std::sin(yaw_)), static_cast<float>(std::sin(pitch_)),
                  static_cast<float>(std::cos(pitch_) * std::cos(yaw_))};
  return {target_ + scaled(distance_, back), target_, fov_degrees_};
}

void Orbit::turn(double right, double down) {
  yaw_ = std::remainder(yaw_ - right, 2 * std::numbers::pi);
  pitch_ = std::clamp(pitch_ + down, -kSteepest, kSteepest);
}

void Orbit::pan(double right, double down) {
  const Axes axes = axes_of(camera());
  const double height = 2 * half_height(fov_degrees_) * distance_;
  target_ = target_ - scaled(right * height, axes.right) + scaled(down * height, axes.up);
}

void Orbit::zoom(double factor) { distance_ = std::clamp(distance_ * factor, kNearest, kFarthest); }

void Orbit::frame(Vec3 low, Vec3 high) {
  const double radius = 0.5 * length(high - low);
  if (!(radius > 0) || !std::isfinite(radius)) return;
  target_ = scaled(0.5, low + high);
  distance_ = std::clamp(radius / std::sin(0.5 * fov_degrees_ * std::numbers::pi / 180), kNearest, kFarthest);
}

}  // namespace weft::view
