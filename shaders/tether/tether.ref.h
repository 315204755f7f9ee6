// Twin of the tethers in finalize: long-range attachment (Kim, Chentanez, Mueller 2012, "Long range attachments: a method to
// simulate inextensible clothing in computer games"). C(p) = |p - a| - max_distance <= 0, one-sided; the anchor is kinematic
// (inverse mass 0), so the constraint is satisfied by moving the particle alone: dp = -C grad C.
#pragma once

#include <algorithm>
#include <cmath>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

struct Tether {
  Vector anchor;          // m, its position now
  double max_distance;    // m
};

inline double tether_value(const Tether& tether, const Vector& p) { return (p - tether.anchor).norm() - tether.max_distance; }
inline Vector tether_gradient(const Tether& tether, const Vector& p) { return (p - tether.anchor).normalized(); }

inline Vector within_tether(const Tether& tether, const Vector& p) {
  const double c = tether_value(tether, p);
  return c > 0 ? Vector(p - c * tether_gradient(tether, p)) : p;
}

/// Brings p as near to the axis through both anchors as the lens in which their balls intersect is wide, where its middle lies
/// between them. In the triangle of the anchors' distance and both max distances the lens' half width is the height (Heron's
/// formula); angles at the anchors below 90 degrees put its foot between them. Where there is no triangle, or none that single
/// precision could resolve: onto the axis.
inline Vector within_lens(const Tether& a, const Tether& b, const Vector& p) {
  const double base = (b.anchor - a.anchor).norm(), half = (base + a.max_distance + b.max_distance) / 2;
  const double a2 = a.max_distance * a.max_distance, b2 = b.max_distance * b.max_distance, base2 = base * base;
  if (a2 + base2 <= b2 || b2 + base2 <= a2) return p;
  constexpr double rounding = 2.5e-7;   // relative to a squared max distance
  const double squared_area = half * (half - base) * (half - a.max_distance) * (half - b.max_distance);
  const double width = std::sqrt(std::max(0.0, 4 * squared_area / base2 - rounding * a2));
  const Vector axis = (b.anchor - a.anchor) / base, off = axis.cross(p - a.anchor).cross(axis);
  return off.norm() > width ? Vector(p + (width - off.norm()) * off.normalized()) : p;
}

/// What a pass makes of `way`, all that the tethers of a particle ask for, where contacts give it a displacement bound (m).
inline constexpr double kTetherShare = 0.1, kTetherShareNearMeshes = 0.05;   // near mesh colliders tethers hook cloth on them
inline Vector share_of(const Vector& way, double bound, double share) {
  const double most = share * bound;
  return way.norm() > most ? Vector(most * way.normalized()) : way;
}

/// Pair after pair, nearest anchor first.
inline Vector within_tethers(std::span<const Tether> tethers, Vector p) {
  for (std::size_t k = 0; k < tethers.size(); k += 2) {
    const bool both = k + 1 < tethers.size();
    if (both) p = within_lens(tethers[k], tethers[k + 1], p);
    p = within_tether(tethers[k], p);
    if (both) p = within_tether(tethers[k + 1], p);
  }
  return p;
}

}  // namespace weft::reference
