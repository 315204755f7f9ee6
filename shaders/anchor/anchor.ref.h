// Twin of anchor: a kinematic particle moves straight and evenly from its position at the frame's start to its target.
#pragma once

#include <algorithm>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// `fraction`: of the frame, at the substep's end.
inline Vector anchor_at(const Vector& from, const Vector& to, double fraction) { return from + fraction * (to - from); }

/// Where an anchor that was held back at x goes in a substep: at most as far as its target moves, `step`, plus `recover` or 0.08
/// of its thickness (m), unless its tracking error at the start, `lag`, is more than `kinematic_lag_limit` thicknesses.
inline Vector anchor_after(const Vector& target, const Vector& x, double step, double lag, double recover, double thickness,
                           double kinematic_lag_limit) {
  const Vector error = target - x;
  const double most = step + std::max(recover, 0.08 * thickness);
  return error.norm() <= most || lag > kinematic_lag_limit * thickness ? target : Vector(x + most * error.normalized());
}

}  // namespace weft::reference
