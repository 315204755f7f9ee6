// Twin of support.glsl: what colliders have put out by d along n in the last substeps has the inverse mass w (I - d / (d + 0.05 mm) n n^T)
// in this one's solve. After: Baraff and Witkin 1998, "Large steps in cloth simulation", whose constraints are I - n n^T.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// s, of the inverse mass w (I - s s^T).
inline Vector support_from(const Vector& put_out) {
  const double d = put_out.norm();
  return d > 1e-9 ? Vector(put_out / std::sqrt(d * (d + 5e-5))) : Vector(Vector::Zero());
}

/// Of particles or nodes.
struct Supports {
  Points put_out;             // m
  std::vector<double> held;   // m, of steps until now; of nodes, over the length of put_out

  /// What is left of a step.
  Vector yields(std::size_t i, const Vector& step) const {
    const Vector s = support_from(put_out[i]);
    return step - s.dot(step) * s;
  }
  /// The depth of the rest (m).
  double held_of(std::size_t i, const Vector& step) const { return -support_from(put_out[i]).dot(step) * support_from(put_out[i]).norm(); }
  Vector move(std::size_t i, const Vector& step) {
    held[i] += held_of(i, step);
    return yields(i, step);
  }
};

/// Of a particle, after an iteration, which `ends` its substep or not (m): colliders have put it out by `put_out`, and `held` of it was held
/// before by `before`.
inline Vector renewed(const Vector& before, double held, const Vector& put_out, bool ends = true) {
  if (put_out.isZero(0)) return ends ? Vector((held < 0 ? 0 : 0.5) * before) : before;
  const Vector n = put_out.normalized();
  const double length = before.norm(), along = before.dot(n);
  const double now = std::min(put_out.norm() + (length > 0 ? std::max(held, 0.0) * std::max(along, 0.0) / length : 0), 0.002);
  if (along > 0.98 * length) return (0.85 * length + 0.15 * now) * n;
  return 0.85 * before + 0.15 * now * n;
}

/// The inverse mass of a link along the unit u, its ends' being w_a and w_b without supports: a quarter of that at least.
inline double supported_weight(const Supports& supports, std::size_t a, double w_a, std::size_t b, double w_b, const Vector& u) {
  const double along_a = support_from(supports.put_out[a]).dot(u), along_b = support_from(supports.put_out[b]).dot(u);
  return std::max(w_a * (1 - along_a * along_a) + w_b * (1 - along_b * along_b), 0.25 * (w_a + w_b));
}

}  // namespace weft::reference
