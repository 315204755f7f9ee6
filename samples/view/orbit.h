// A camera that turns about a point, and the ray under a place of its picture.
#pragma once

#include "engine/scene.h"

namespace weft::view {

struct Ray {
  Vec3 origin;      // m
  Vec3 direction;   // unit
};

/// `x` and `y` from -1 to 1 over the picture, rightwards and downwards; `aspect`: width over height.
Ray ray_through(const Camera& camera, double x, double y, double aspect);

/// The place of a point in the picture, as above; z is its distance along the camera's axis (m), not above 0 behind it.
Vec3 seen_at(const Camera& camera, Vec3 point, double aspect);

class Orbit {
 public:
  Orbit() = default;
  explicit Orbit(const Camera& camera);

  Camera camera() const;
  Vec3 target() const { return target_; }
  double distance() const { return distance_; }

  /// Radians, to the right and downwards: the scene turns along with the pointer. Stops short of straight up and straight down.
  void turn(double right, double down);
  /// In heights of the picture, at the target's distance: the scene goes along with the pointer.
  void pan(double right, double down);
  /// The distance is multiplied by `factor` > 0, within 1 mm to 10 km.
  void zoom(double factor);
  /// Looks at the middle of a box from so far that the ball about it fills the picture. A box without a size, or one that is not finite,
  /// changes nothing.
  void frame(Vec3 low, Vec3 high);

 private:
  Vec3 target_;
  double distance_ = 1;   // m
  double yaw_ = 0, pitch_ = 0;   // radians: 0 looks along -z, and level
  double fov_degrees_ = 40;
};

}  // namespace weft::view
