// Twin of inertia in double precision, from what the frame did and not from a map of velocities.
#pragma once

#include <Eigen/Geometry>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// What a frame did in a time: about its place it turned by `turn`, and that moved by `way`.
struct FrameMotion {
  Vector way;                    // m
  Eigen::Quaterniond turn;
  double seconds;
};

/// The velocity after inertia of a particle at x with velocity w, where a frame at `centre` did `before` and will do `next`. What is taken
/// out of it: 1 - the factors.
inline Vector without_inertia(const Vector& x, const Vector& w, const Vector& centre, const FrameMotion& before, const FrameMotion& next,
                              double linear, double angular, double centrifugal) {
  const Vector r = x - centre;
  const auto turning = [](const FrameMotion& m) { return Eigen::AngleAxisd(m.turn); };
  const Eigen::AngleAxisd a = turning(before), b = turning(next);
  const auto across = [&](const Eigen::AngleAxisd& t, const FrameMotion& m) { return Vector(std::sin(t.angle()) / m.seconds * t.axis().cross(r)); };
  const auto inwards = [&](const Eigen::AngleAxisd& t, const FrameMotion& m) {
    return Vector((1 - std::cos(t.angle())) / m.seconds * t.axis().cross(t.axis().cross(r)));
  };
  // In the frame before, what goes with it arrived at x with this velocity; what is relative to that turns along.
  const Vector carried = before.way / before.seconds + across(a, before) - inwards(a, before);
  const Eigen::Matrix3d along = Eigen::AngleAxisd((1 - angular) * a.angle(), a.axis()).toRotationMatrix();
  return w + (1 - linear) * (next.way / next.seconds - before.way / before.seconds) + (1 - angular) * (across(b, next) - across(a, before)) +
         (1 - centrifugal) * (inwards(b, next) + inwards(a, before)) + (along * (w - carried) - (w - carried));
}

}  // namespace weft::reference
