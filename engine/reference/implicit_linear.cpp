// The two solvers of the linear system of a step: see implicit.h.
#include <cmath>

#include "engine/reference/implicit.h"

namespace weft::reference {
namespace {

double product(const Columns& a, const Columns& b) { return a.cwiseProduct(b).sum(); }

Columns by_blocks(const ImplicitEquations& equations, const Columns& r) {
  Columns z(3, r.cols());
  for (Eigen::Index i = 0; i < r.cols(); ++i) z.col(i) = equations.filter[i] * (equations.inverse[i] * r.col(i));
  return z;
}

Columns preconditioned(const ImplicitEquations& equations, const Columns& r) {
  const Columns z = by_blocks(equations, r);
  return equations.levels ? z + equations.filtered(equations.levels->changes(r, equations.level_blocks)) : z;
}

// Line search along the guess, to the least error in the norm of A; updates r. Counts as an iteration.
void follow_guess(const ImplicitEquations& equations, ImplicitSolution& solution, Columns& r) {
  const Columns image = equations.filtered(equations.times(equations.guess));
  const double curvature = product(equations.guess, image);
  ++solution.iterations;
  if (!(curvature > 0)) return;
  const double step = product(r, equations.guess) / curvature;
  solution.change = step * equations.guess;
  r -= step * image;
}

}  // namespace

Columns ImplicitEquations::times(const Columns& p) const {
  Columns product = p * masses.asDiagonal();
  for (const Coupling& c : couplings) {
    const Vector along = c.block * (p.col(c.a) - p.col(c.b));
    product.col(c.a) += along;
    product.col(c.b) -= along;
  }
  return product;
}

Columns ImplicitEquations::filtered(Columns p) const {
  for (Eigen::Index i = 0; i < p.cols(); ++i) p.col(i) = filter[i] * p.col(i);
  return p;
}

void ImplicitEquations::keep_momentum(Columns& change) const {
  for (const ClothRange& cloth : free) {
    const Eigen::Index first = cloth.first_particle, count = cloth.particles;
    const Eigen::VectorXd weights = masses.segment(first, count);
    const Vector mean = change.middleCols(first, count) * weights / weights.sum();
    change.middleCols(first, count).colwise() -= mean;
  }
}

double ImplicitEquations::residual(const Columns& change) const {
  const double whole = right.norm();
  return whole > 0 ? (right - filtered(times(change))).norm() / whole : 0;
}

// Preconditioned conjugate gradients with the filter of Baraff and Witkin 1998, section 5.3. Prescribed velocities are in the
// free flight already. The error in the norm of A falls in every iteration, so the last iterate is the best whenever the
// solve stops.
ImplicitSolution solve_conjugate_gradients(const ImplicitEquations& equations, std::uint32_t iterations, double tolerance) {
  ImplicitSolution solution{Columns::Zero(3, equations.right.cols())};
  const double whole = equations.right.norm();
  if (!(whole > 0)) return solution;
  Columns r = equations.right;
  if (iterations > 0) follow_guess(equations, solution, r);
  Columns z = preconditioned(equations, r), p = z;
  double gamma = product(r, z);
  while (solution.iterations < iterations && r.norm() > tolerance * whole) {
    const Columns image = equations.filtered(equations.times(p));
    const double curvature = product(p, image);
    if (!(curvature > 0) || !std::isfinite(gamma / curvature)) {
      solution.stopped = r.norm() > 1e-12 * whole;   // a residual at the rounding of doubles is solved
      break;
    }
    solution.change += gamma / curvature * p;
    r -= gamma / curvature * image;
    z = preconditioned(equations, r);
    const double next = product(r, z);
    p = z + next / gamma * p;
    gamma = next;
    ++solution.iterations;
  }
  solution.residual = equations.residual(solution.change);
  return solution;
}

// Damped block Jacobi. The residual is measured as r . D^-1 r: in that norm I - w A D^-1 is symmetric, so the residual falls
// in every iteration if Jacobi converges, and where it grows Jacobi does not.
ImplicitSolution solve_jacobi(const ImplicitEquations& equations, std::uint32_t iterations, double weight, double tolerance) {
  ImplicitSolution solution{Columns::Zero(3, equations.right.cols())};
  const double whole = equations.right.norm();
  if (!(whole > 0)) return solution;
  Columns r = equations.right;
  if (iterations > 0) follow_guess(equations, solution, r);
  Columns z = by_blocks(equations, r);
  double gamma = product(r, z);
  while (solution.iterations < iterations && r.norm() > tolerance * whole) {
    const Columns r_next = r - weight * equations.filtered(equations.times(z));
    const Columns z_next = by_blocks(equations, r_next);
    const double next = product(r_next, z_next);
    if (!(next < gamma)) {
      solution.stopped = true;
      break;
    }
    solution.change += weight * z;
    r = r_next;
    z = z_next;
    gamma = next;
    ++solution.iterations;
  }
  solution.residual = equations.residual(solution.change);
  return solution;
}

}  // namespace weft::reference
