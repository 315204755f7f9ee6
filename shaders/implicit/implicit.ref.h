// Twin of the implicit passes: what a spring adds to the linear system of a step of implicit Euler
// (Baraff and Witkin 1998, "Large steps in cloth simulation", eq. 6, 7 and 10).
//
// A spring between a and b with d = x_a - x_b, l = |d|, n = d / l pushes a with
//     f = -k (l - L) n - c (n . (v_a - v_b)) n
// and b with the opposite. Its stiffness -df/dx is k ((1 - L/l) (I - n n^T) + n n^T). A compressed spring has L > l: its
// part across n is negative, the matrix of the step stops being positive definite, and neither conjugate gradients nor
// Jacobi has anything to converge to. That part is left out (Choi and Ko 2002, "Stable but responsive cloth", section 4: a
// spring under compression gives way by buckling). So is the change of n in the damping force, which is not symmetric.
//
// A spring of rest length 0 is linear, of either sign: the isometric bending energy is a set of these.
#pragma once

#include <algorithm>

#include "shaders/jacobi.ref.h"

namespace weft::reference {

using Matrix = Eigen::Matrix3d;

struct ImplicitSpring {
  double rest;         // m
  double stiffness;    // N/m
  double damping;      // N s/m
  bool only_pulls;
};

/// What a spring with its ends d = x_a - x_b apart, which part with the velocity u = v_a - v_b, does to a; to b the opposite.
struct SpringTerms {
  Vector force = Vector::Zero();        // N
  Matrix stiffness = Matrix::Zero();    // N/m: -df/dx, without what makes it indefinite
  Matrix damping = Matrix::Zero();      // N s/m: -df/dv
};

inline SpringTerms spring_terms(const ImplicitSpring& spring, const Vector& d, const Vector& u) {
  if (spring.rest == 0) return {-spring.stiffness * d, spring.stiffness * Matrix::Identity(), Matrix::Zero()};
  const double length = d.norm();
  if (!(length > 1e-10) || (spring.only_pulls && length < spring.rest)) return {};   // no direction, or slack
  const Vector n = d / length;
  const Matrix along = n * n.transpose();
  const double across = std::max(0.0, 1 - spring.rest / length);
  return {-spring.stiffness * (length - spring.rest) * n - spring.damping * n.dot(u) * n,
          spring.stiffness * (across * (Matrix::Identity() - along) + along), spring.damping * along};
}

}  // namespace weft::reference
