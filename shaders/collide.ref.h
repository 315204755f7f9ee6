// Twin of the colliders in settle: bodies as signed distances, C(p) = distance(p) - thickness >= 0, and Coulomb friction.
//
// Push-out: a point with C < 0 goes along the distance's gradient until C = 0, whatever its history. A point that starts and
// ends outside a sphere but passed through it on its straight way, seen from the moving sphere, is put out where it was
// deepest. Friction (Mueller, Heidelberger, Hennix, Ratcliff 2007; Macklin et al. 2014, "Unified particle physics", eq. 24
// with one coefficient): the normal correction of depth d stands for the normal impulse, so the tangential motion relative
// to the body's surface is taken back by at most mu d. A tangential motion shorter than that is taken back whole: it sticks.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "shaders/relax.ref.h"

namespace weft::reference {

/// How a body moves in one substep.
struct Body {
  Vector centre_before, centre_after;   // m; a point of the plane, or the sphere's centre
  Vector normal_before, normal_after;   // unit; planes
  double radius;                        // m; below 0 marks a plane
  Vector turn;                          // rad in this substep, about the centre
  double friction;                      // of the pair: geometric mean of both coefficients
  bool is_plane() const { return radius < 0; }
};

inline double signed_distance(const Body& body, const Vector& p) {
  if (body.is_plane()) return (p - body.centre_after).dot(body.normal_after);
  return (p - body.centre_after).norm() - body.radius;
}
/// Unit; +y in a sphere's centre, where there is no direction.
inline Vector distance_gradient(const Body& body, const Vector& p) {
  if (body.is_plane()) return body.normal_after;
  const Vector d = p - body.centre_after;
  return d.norm() > 1e-9 ? Vector(d.normalized()) : Vector::UnitY();
}

/// The motion in this substep of the body's point that is now at p, to first order.
inline Vector carried(const Body& body, const Vector& p) {
  return body.centre_after - body.centre_before + body.turn.cross(p - body.centre_after);
}

/// Coulomb: `to` is on the surface, put there by `depth` along `normal`; x is where the substep began.
inline Vector rub(const Body& body, const Vector& x, const Vector& to, const Vector& normal, double depth) {
  const Vector motion = to - x - carried(body, to);
  const Vector slip = (Eigen::Matrix3d::Identity() - normal * normal.transpose()) * motion;
  const double taken_back = std::min(slip.norm(), body.friction * depth);
  return slip.norm() > 1e-12 ? Vector(to - taken_back * slip.normalized()) : to;
}

/// Where p, which was at x when the substep began, must be for the body.
inline Vector out_of_body(const Body& body, const Vector& x, const Vector& p, double thickness) {
  Vector deepest = p;
  if (signed_distance(body, p) >= thickness) {
    if (body.is_plane()) return p;   // a half-space keeps no one who has passed through
    // In the sphere's frame the point moved from `start` to `end`; its nearest approach lies at t.
    const Vector start = x - body.centre_before, end = p - body.centre_after, way = end - start;
    if (start.norm() < body.radius + thickness || way.norm() == 0) return p;
    const double t = -start.dot(way) / way.squaredNorm();
    if (t <= 0 || t >= 1) return p;
    deepest = body.centre_after + start + t * way;
    if (signed_distance(body, deepest) >= thickness) return p;
  }
  const double depth = thickness - signed_distance(body, deepest);
  const Vector normal = distance_gradient(body, deepest);
  return rub(body, x, deepest + depth * normal, normal, depth);
}

}  // namespace weft::reference
