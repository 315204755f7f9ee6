// Twin of the colliders in finalize: bodies as signed distances, C(p) = distance(p) - thickness >= 0, and Coulomb friction.
//
// Projection: a point with C < 0 moves along the distance's gradient until C = 0, whatever its history. A point that starts and
// ends outside a sphere but passed through it, on a straight line relative to the moving sphere, is put out where it was
// deepest. Capsules and boxes are convex, so a point that entered one, relative to the body, is held by the tangent plane at the
// place of entry if it came out again or if the nearest way out leads on, not back. Friction (Mueller, Heidelberger, Hennix,
// Ratcliff 2007; Macklin et al. 2014, "Unified particle physics", eq. 24 with one coefficient): the normal correction of depth d
// stands for the normal impulse, so the tangential motion relative to the body's surface is reduced by at most mu d. A
// tangential motion shorter than that is taken back whole: static friction.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

enum class Shape { plane, sphere, capsule, box };

/// How a body moves in one substep.
struct Body {
  Shape shape = Shape::plane;
  Vector centre_before = Vector::Zero(), centre_after = Vector::Zero();   // m; a point of the plane, or the middle
  Vector normal_before = Vector::UnitY(), normal_after = Vector::UnitY(); // unit; planes
  double radius = 0;                                                      // m; spheres and capsules
  double taper = 0;                      // m; capsules: by how much the radius of the end along y is less than that of the other, `radius`
  Vector half_size = Vector::Zero();     // m: half a box's sides; y: half a capsule's length
  Eigen::Quaterniond rotation_before = Eigen::Quaterniond::Identity(), rotation_after = Eigen::Quaterniond::Identity();
  Vector turn = Vector::Zero();          // rad in this substep, about the centre: rotation_after = exp(turn) rotation_before
  double friction = 0;                   // of the pair: geometric mean of both coefficients

  bool has_axes() const { return shape == Shape::capsule || shape == Shape::box; }
  Vector own_before(const Vector& p) const { return rotation_before.conjugate() * (p - centre_before); }
  Vector own_after(const Vector& p) const { return rotation_after.conjugate() * (p - centre_after); }
};

/// Whether one end of a capsule lies in the other.
inline bool is_swallowed(const Body& body) { return std::abs(body.taper) >= 2 * body.half_size.y(); }

/// The point of a capsule's core or of a box that is nearest to p, in the body's axes.
inline Vector nearest_of_core(const Body& body, const Vector& p) {
  if (body.taper != 0 && is_swallowed(body)) return {0, std::copysign(body.half_size.y(), -body.taper), 0};
  if (body.shape == Shape::capsule) return {0, std::clamp(p.y(), -body.half_size.y(), body.half_size.y()), 0};
  return p.cwiseMax(-body.half_size).cwiseMin(body.half_size);
}

/// A capsule with two radii, in its axes: its distance by cases (Quilez, "Round cone"), with the gradient. p is nearest to an end's sphere
/// or to the side between, whose normals rise by the sine b.
struct RoundCone {
  double distance = 0;
  Vector gradient = Vector::UnitX();
};
inline RoundCone round_cone(const Body& body, const Vector& p) {
  const double half = body.half_size.y(), length = 2 * half;
  const double b = is_swallowed(body) ? 0 : body.taper / length, a = std::sqrt(1 - b * b);
  const double x = std::hypot(p.x(), p.z()), y = p.y() + half, along = a * y - b * x;
  const auto to_end = [&](double height, double radius) {
    const Vector d = p - Vector(0, height, 0);
    return RoundCone{d.norm() - radius, d.norm() > 1e-9 ? Vector(d.normalized()) : Vector(a, b, 0)};
  };
  if (is_swallowed(body) ? body.taper > 0 : along < 0) return to_end(-half, body.radius);
  if (is_swallowed(body) || along > a * length) return to_end(half, body.radius - body.taper);
  return {a * x + b * y - body.radius, x > 1e-9 ? Vector(a * p.x() / x, b, a * p.z() / x) : Vector(a, b, 0)};
}

/// Signed distance in the axes of a capsule or box. A box's inside is as deep as its nearest face is far.
inline double own_distance(const Body& body, const Vector& p) {
  if (body.taper != 0) return round_cone(body, p).distance;
  const double outside = (p - nearest_of_core(body, p)).norm();
  if (body.shape == Shape::capsule) return outside - body.radius;
  return outside > 0 ? outside : -(body.half_size - p.cwiseAbs()).minCoeff();
}
inline Vector own_gradient(const Body& body, const Vector& p) {
  if (body.taper != 0) return round_cone(body, p).gradient;
  const Vector outward = p - nearest_of_core(body, p);
  if (body.shape == Shape::capsule) return outward.norm() > 1e-9 ? Vector(outward.normalized()) : Vector::UnitX();
  if (outward.norm() > 0) return outward.normalized();
  int face = 0;
  (body.half_size - p.cwiseAbs()).minCoeff(&face);
  return (p[face] < 0 ? -1.0 : 1.0) * Vector::Unit(face);
}

/// The fraction at which the segment from a, outside, to b enters the body; 2 for never. The body is convex, so
/// its distance falls to one minimum and rises again; the entry lies between the start and the minimum.
inline double own_entry(const Body& body, const Vector& a, const Vector& b) {
  const auto distance = [&](double t) { return own_distance(body, a + t * (b - a)); };
  if (distance(0) < 0) return 2;
  double low = 0, high = 1;
  for (int k = 0; k < 200; ++k) {
    const double third = (high - low) / 3;
    if (distance(low + third) < distance(high - third)) high -= third;
    else low += third;
  }
  double outside = 0, inside = 0.5 * (low + high);
  if (distance(inside) >= 0) return 2;
  for (int k = 0; k < 100; ++k) (distance(0.5 * (outside + inside)) < 0 ? inside : outside) = 0.5 * (outside + inside);
  return outside;
}

inline double signed_distance(const Body& body, const Vector& p) {
  if (body.shape == Shape::plane) return (p - body.centre_after).dot(body.normal_after);
  if (body.has_axes()) return own_distance(body, body.own_after(p));
  return (p - body.centre_after).norm() - body.radius;
}
/// Unit; +y in a sphere's centre, where there is no direction.
inline Vector distance_gradient(const Body& body, const Vector& p) {
  if (body.shape == Shape::plane) return body.normal_after;
  if (body.has_axes()) return body.rotation_after * own_gradient(body, body.own_after(p));
  const Vector d = p - body.centre_after;
  return d.norm() > 1e-9 ? Vector(d.normalized()) : Vector::UnitY();
}

/// The motion in this substep of the body's point that is now at p; to first order for planes and spheres.
inline Vector carried(const Body& body, const Vector& p) {
  if (body.has_axes()) return p - (body.centre_before + body.rotation_before * body.own_after(p));
  return body.centre_after - body.centre_before + body.turn.cross(p - body.centre_after);
}

/// Coulomb: `to` is on the surface, put there by `depth` along `normal`; x is where the substep began; `held`: as in out_of_body.
inline Vector rub(const Body& body, const Vector& x, const Vector& to, const Vector& normal, double depth,
                  const Vector& held) {
  const Vector motion = to - x - carried(body, to);
  const Vector slip = (Eigen::Matrix3d::Identity() - normal * normal.transpose()) * motion;
  const double taken_back = std::min(slip.norm(), body.friction * std::max(depth + held.dot(normal), 0.0));
  return slip.norm() > 1e-12 ? Vector(to - taken_back * slip.normalized()) : to;
}

/// As out_of_body, for a body with axes, where the point may have to stay in front of its entry.
inline Vector out_of_convex(const Body& body, const Vector& x, const Vector& p, double thickness, const Vector& held) {
  const Vector a = body.own_before(x), b = body.own_after(p);
  double distance = own_distance(body, b);
  Vector normal = own_gradient(body, b);
  if (const double t = own_entry(body, a, b); t < 1) {
    const Vector place = a + t * (b - a), tangent = own_gradient(body, place + 1e-9 * (a - b).normalized());
    if (distance >= thickness || normal.dot(tangent) <= 0) {
      distance = (b - place).dot(tangent);
      normal = tangent;
    }
  }
  if (distance >= thickness) return p;
  const Vector out = body.rotation_after * normal;
  return rub(body, x, p + (thickness - distance) * out, out, thickness - distance, held);
}

/// Where p, which was at x when the substep began, must be for the body. `held`: what of its steps into bodies the solve held back,
/// outwards (m, support.ref.h).
inline Vector out_of_body(const Body& body, const Vector& x, const Vector& p, double thickness,
                          const Vector& held = Vector::Zero()) {
  if (body.has_axes()) return out_of_convex(body, x, p, thickness, held);
  Vector deepest = p;
  if (signed_distance(body, p) >= thickness) {
    if (body.shape == Shape::plane) return p;   // a half-space keeps no one who has passed through
    // In the sphere's frame the point moved from `start` to `end`; its nearest approach lies at t.
    const Vector start = x - body.centre_before, end = p - body.centre_after, segment = end - start;
    if (start.norm() < body.radius + thickness || segment.norm() == 0) return p;
    const double t = -start.dot(segment) / segment.squaredNorm();
    if (t <= 0 || t >= 1) return p;
    deepest = body.centre_after + start + t * segment;
    if (signed_distance(body, deepest) >= thickness) return p;
  }
  const double depth = thickness - signed_distance(body, deepest);
  const Vector normal = distance_gradient(body, deepest);
  return rub(body, x, deepest + depth * normal, normal, depth, held);
}

}  // namespace weft::reference
