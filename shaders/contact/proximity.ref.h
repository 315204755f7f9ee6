// Twin of proximity: closest points by least squares over features, in double precision. A feature is a corner, an edge or a
// face of side A together with one of side B. The closest points of the two features' affine hulls solve min |x_0 + E c|, E
// being the directions in which they extend; they count if they lie inside both features. The nearest that counts is the
// answer. Pairs of corners always count, so there is one.
#pragma once

#include <Eigen/Dense>

#include <array>
#include <limits>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

/// Signed weights over four particles: sum w_j x_j leads from side B's closest point to side A's (m).
using Weights = Eigen::Vector4d;

struct Proximity {
  Weights weights;
  double distance;   // m
};

using Quad = std::array<Vector, 4>;

/// Relative to the first particle: the weights sum to 0.
inline Vector offset(const Weights& w, const Quad& x) { return w[1] * (x[1] - x[0]) + w[2] * (x[2] - x[0]) + w[3] * (x[3] - x[0]); }

/// Between the first `a` particles and the others.
inline Proximity closest(const Quad& x, int a) {
  Proximity best{Weights::Zero(), std::numeric_limits<double>::infinity()};
  for (unsigned feature = 1; feature < 16; ++feature) {   // bit j: particle j is a corner of the feature
    std::vector<int> side_a, side_b;
    for (int j = 0; j < 4; ++j)
      if (feature >> j & 1) (j < a ? side_a : side_b).push_back(j);
    if (side_a.empty() || side_b.empty()) continue;
    Weights weights = Weights::Unit(side_a[0]) - Weights::Unit(side_b[0]);
    const auto free = static_cast<Eigen::Index>(side_a.size() + side_b.size() - 2);
    if (free > 0) {
      Eigen::MatrixXd change(4, free), along(3, free);
      Eigen::Index k = 0;
      for (std::size_t j = 1; j < side_a.size(); ++j) change.col(k++) = Weights::Unit(side_a[j]) - Weights::Unit(side_a[0]);
      for (std::size_t j = 1; j < side_b.size(); ++j) change.col(k++) = Weights::Unit(side_b[0]) - Weights::Unit(side_b[j]);
      for (k = 0; k < free; ++k) along.col(k) = offset(change.col(k), x);
      weights += change * along.completeOrthogonalDecomposition().solve(-offset(weights, x));
    }
    bool inside = true;
    for (int j = 0; j < 4; ++j) inside = inside && (j < a ? weights[j] : -weights[j]) >= 0;
    const double distance = offset(weights, x).norm();
    if (inside && distance < best.distance) best = {weights, distance};
  }
  return best;
}

/// Of p to the triangle a, b, c: weights (1, -u, -v, -w).
inline Proximity closest_to_triangle(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
  return closest({p, a, b, c}, 1);
}

/// Of the edge a, b to the edge c, d: weights (1-s, s, -(1-t), -t).
inline Proximity closest_of_edges(const Vector& a, const Vector& b, const Vector& c, const Vector& d) { return closest({a, b, c, d}, 2); }

}  // namespace weft::reference
