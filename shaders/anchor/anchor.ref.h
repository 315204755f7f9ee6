// Twin of anchor: a held particle goes straight and evenly from where it was at the frame's start to its target.
#pragma once

#include <algorithm>

#include "shaders/stretch/jacobi.ref.h"

namespace weft::reference {

/// `fraction`: of the frame, at the substep's end.
inline Vector anchor_at(const Vector& from, const Vector& to, double fraction) { return from + fraction * (to - from); }

/// Where one goes in a substep that was held back at x: at most as far as its target goes, `step`, and `recover` (m) or 0.08 of its
/// thickness (m), unless it lags more than `patience` thicknesses.
inline Vector anchor_after(const Vector& target, const Vector& x, double step, double recover, double thickness, double patience) {
  const Vector lag = target - x;
  const double most = step + std::max(recover, 0.08 * thickness);
  return lag.norm() <= most || lag.norm() > patience * thickness ? target : Vector(x + most * lag.normalized());
}

}  // namespace weft::reference
