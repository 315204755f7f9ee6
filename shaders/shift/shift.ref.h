// Twin of shift.glsl: how a link's shift follows its error.
#pragma once

#include <algorithm>
#include <cmath>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// A link's shift (m) after a frame of dt seconds; `gives_way` as in shift.glsl, the rates in 1/s.
struct Shift {
  double rest;   // m
  double gives_way;
  bool only_pulls;

  /// `speed`: of the faster end (m/s).
  double renewed(double before, const Vector& a, const Vector& b, double speed, double dt, double follows, double forgets) const {
    const double c = (a - b).norm() - rest, error = (1 - gives_way) * c - gives_way * before, most = 0.1 * rest;
    const double after = std::clamp(before + dt * (follows * error - forgets * before), only_pulls ? 0 : -most, most);
    return before + std::min(1.0, speed * speed / (0.03 * 0.03)) * (after - before);
  }
};

}  // namespace weft::reference
