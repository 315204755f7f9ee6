// Twin of the tethers in settle: long-range attachment (Kim, Chentanez, Mueller 2012, "Long range attachments: a method to
// simulate inextensible clothing in computer games"). C(p) = |p - a| - reach <= 0, one-sided; the anchor has no inverse mass,
// so the constraint is met by moving the particle alone: dp = -C grad C.
#pragma once

#include <algorithm>

#include "shaders/relax.ref.h"

namespace weft::reference {

struct Tether {
  Vector anchor;   // m, where it is now
  double reach;    // m
};

inline double tether_value(const Tether& tether, const Vector& p) { return (p - tether.anchor).norm() - tether.reach; }
inline Vector tether_gradient(const Tether& tether, const Vector& p) { return (p - tether.anchor).normalized(); }

inline Vector within_tether(const Tether& tether, const Vector& p) {
  const double c = tether_value(tether, p);
  return c > 0 ? Vector(p - c * tether_gradient(tether, p)) : p;
}

/// One after another, nearest anchor first.
inline Vector within_tethers(std::span<const Tether> tethers, Vector p) {
  for (const Tether& tether : tethers) p = within_tether(tether, p);
  return p;
}

}  // namespace weft::reference
