// The implicit particle system on the CPU, in double precision: implicit Euler on springs, after Baraff and Witkin 1998.
//
// A substep of h solves one linear system for the change of the velocities against a free flight v* = exp(-c h) (v + h g),
//     (M + h D + h^2 K) dv = h f(x, v*) - h^2 K v*,     v <- v* + dv,  x <- x + h v,
// with the springs' stiffness K and damping D at x (shaders/implicit/implicit.ref.h). That is one Newton step of implicit Euler.
//
// The matrix is a mass on every particle and a 3x3 block on every spring, A = M + sum (e_a - e_b) B (e_a - e_b)^T, all of them
// positive semidefinite: in any pose there is one solution, and both solvers converge to it.
//  - Conjugate gradients, preconditioned by the blocks on the diagonal, with the filter of Baraff and Witkin (section 5.3):
//    directions of a particle that are prescribed (held particles, colliders) are removed from every residual. With coarse levels
//    the preconditioner has these, too.
//  - Damped block Jacobi, dv <- dv + w D^-1 (b - A dv). A pair's [B -B; -B B] is at most twice its diagonal and a bending
//    stencil of four particles at most four times, so no eigenvalue of D^-1 A is above 2, or 4: any w below 1, or 1/2,
//    converges. With w = 2/3, or 1/3, no mode overshoots by more than a third however few iterations there are, so the motion
//    stays bounded when the solver is stopped early (engine/README.md, "Implicit").
//
// The first iteration is a line search from the free flight towards the velocity before the substep, the guess. In free fall
// its step is zero, and in a cloth that hangs at rest it goes all the way: both are exact after one iteration. From the free
// flight alone every substep would leave a part of the fall unsolved, and a cloth at rest would sag.
//
// Momentum: the springs of a free cloth conserve it, but an unfinished solve does not. The mean change of such a cloth's
// velocity is subtracted at the end, which is the best constant correction in the norm of A.
//
// Planes constrain the direction across them: a particle that would end below goes onto the plane, and the filter takes that
// direction out of its residual, unless the springs would pull it off. If they fail to, it is projected onto the plane after
// the solve. On the GPU all colliders with a signed distance do so, with friction (shaders/implicit/implicit_collide.glsl).
//
// Limitations: springs only; planes that stand still, without friction; no tethers; one thread.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compute/result.h"
#include "engine/fabric.h"
#include "engine/reference/implicit_levels.h"
#include "engine/scene.h"
#include "shaders/implicit/implicit.ref.h"

namespace weft::reference {

/// One column a particle, in CookedFabric's order.
using Columns = Eigen::Matrix3Xd;

/// A dv = b in the directions that the filter leaves.
struct ImplicitEquations {
  struct Coupling {
    std::uint32_t a, b;
    Matrix block;                  // kg
  };
  Eigen::VectorXd masses;          // kg
  std::vector<Coupling> couplings;
  std::vector<Matrix> diagonal;    // kg: 3x3 blocks of A
  std::vector<Matrix> inverse;     // of these
  std::vector<Matrix> filter;      // a projection: identity for what is free, zero for what is held
  Columns right;                   // b, filtered (kg m/s)
  Columns flight;                  // v* (m/s)
  Columns guess;                   // the velocity before less v*, filtered (m/s)
  std::shared_ptr<const ImplicitLevels> levels;   // in the preconditioner; null: none
  ImplicitLevels::Blocks level_blocks;            // of their nodes
  std::vector<ClothRange> free;    // cloths without a held or constrained particle

  Columns times(const Columns& p) const;         // A p, not filtered
  Columns filtered(Columns p) const;
  void keep_momentum(Columns& change) const;     // conserves that of the free cloths
  /// |b - A dv| over |b|, both filtered: 0 is solved, 1 is nothing done.
  double residual(const Columns& change) const;
};

struct ImplicitSolution {
  Columns change;                  // dv (m/s)
  std::uint32_t iterations = 0;    // that were made
  double residual = 0;             // |b - A dv| over |b|
  bool stopped = false;            // the error began to grow, or the arithmetic broke down: `change` is the best so far
};

/// At most so many iterations, fewer where the residual falls to `tolerance`. Always finite.
ImplicitSolution solve_conjugate_gradients(const ImplicitEquations& equations, std::uint32_t iterations, double tolerance = 0);
/// `weight`: see above; one that does not converge is stopped when the error grows.
ImplicitSolution solve_jacobi(const ImplicitEquations& equations, std::uint32_t iterations, double weight, double tolerance = 0);

/// The position of a held particle at the substep's end.
struct ImplicitTarget {
  std::uint32_t particle;
  Vector position;                 // m
};

/// Counts of the substeps so far.
struct ImplicitReport {
  std::uint64_t steps = 0;
  std::uint64_t not_converged = 0; // whose residual stayed above kConverged
  std::uint64_t stopped = 0;       // whose solver stopped early
  double residual = 0;             // of the last
};

class ImplicitSystem {
 public:
  static constexpr double kConverged = 0.01;

  /// Errors: a scene whose method is not "implicit", or with colliders that are no planes or move.
  static Result<ImplicitSystem> create(const Scene& scene, const CookedFabric& fabric);

  /// The equations of the next substep. Held particles go to their targets, or stay.
  ImplicitEquations assemble(std::span<const ImplicitTarget> targets = {}) const;
  /// Solves them as the scene says.
  ImplicitSolution solve(const ImplicitEquations& equations) const;
  /// Advances velocities and positions by a solution.
  void move(const ImplicitEquations& equations, const ImplicitSolution& solution, std::span<const ImplicitTarget> targets = {});
  /// All three.
  void step(std::span<const ImplicitTarget> targets = {});

  Columns positions, velocities;   // m, m/s: may be written between steps
  double jacobi_weight = 0;        // CookedFabric's
  const ImplicitReport& report() const { return report_; }
  double h() const { return h_; }

 private:
  struct Plane {
    Vector normal;
    Vector point;                  // m
  };
  void meet_planes(ImplicitEquations& equations, Columns& impulse) const;

  SolverSettings settings_;
  Vector gravity_;
  double h_ = 0;
  Eigen::VectorXd inverse_masses_, keep_, thickness_;   // 1/kg; damping factor of the velocity in a substep; m
  std::vector<ParticleSpring> springs_;
  std::vector<ClothRange> cloths_;
  std::vector<Plane> planes_;
  std::shared_ptr<const ImplicitLevels> levels_;
  ImplicitReport report_;
};

}  // namespace weft::reference
