// One time step as a problem to be solved: find the displacement u from the free motion y, and the multipliers lambda, with
//
//     M u = sum grad C lambda - sum K k l          balance of forces
//     C + (alpha / h^2) lambda = 0                 every link pulls as hard as its compliance says
//     lambda <= 0 for links that only pull, and 0 where they are slack
//
// which are the stationary points of the incremental potential 1/2 |u|_M^2 + h^2 E(y + u) (Macklin et al. 2016, eq. 8 and 9,
// without dropping any term). Multipliers are unknowns of their own: a stiff link's C is a small difference of large lengths,
// and forces computed from it alone would amplify its rounding.
//
// A Newton step eliminates the multipliers (their block is diagonal), which leaves a symmetric system in the particles,
//
//     (M + sum K k K^T - sum lambda grad^2 C + sum grad C (h^2 / alpha) grad C^T) du = -residual,
//
// solved by conjugate gradients, preconditioned with the sparse Cholesky factor of its stiff part between neighbours in the
// mesh and of the diagonal of the rest. Links of eight edges would fill that factor a hundredfold, and without them the
// condition number stays small (energies.h). The factor is reused, over time steps too, until conjugate gradients take too
// many iterations with it.
#pragma once

#include "engine/reference/block_factor.h"
#include "engine/reference/energies.h"

namespace weft::reference {

class TimeStep {
 public:
  explicit TimeStep(Energies energies);

  /// Begins the next step, from the free motion y (m). Displacements and multipliers start from those of the step before, or
  /// from their linear extrapolation.
  void begin(const Positions& free_motion);
  /// Newton's method, until the residual is at most `tolerance` times `scale` (m) or times the largest displacement. False: not
  /// converged.
  bool solve(double tolerance, double scale, std::uint32_t most_steps);

  const Positions& displacement() const { return now_.u; }
  std::uint64_t newton_steps() const { return newton_steps_; }

 private:
  struct State {
    Positions u;                         // m
    Eigen::VectorXd lambda;              // kg m
  };
  // A link in a state.
  struct LinkFrame {
    Eigen::Vector3d normal;
    double length, value;                // m: |d| and C + softness lambda
    bool active;
  };
  struct Residual {
    std::vector<LinkFrame> frames;
    Positions force;                     // kg m: M u - sum grad C lambda + sum K k l
    double size = 0;                     // m
    double potential = 0;                // kg m^2
  };

  struct Curl {
    Eigen::Vector3d l;                   // m
    double terms;                        // m
  };

  Residual evaluate(State& state) const;
  Curl curl(const BendEnergy& bend, const Positions& u) const;
  Positions apply(const Residual& at, const Eigen::VectorXd& lambda, const Positions& p, bool projected) const;
  void factorise(const Residual& at, const Eigen::VectorXd& lambda);
  // Conjugate gradients; false where they meet a direction of negative curvature.
  bool solve_linear(const Residual& at, const Eigen::VectorXd& lambda, const Positions& rhs, bool projected, double enough, Positions& du);

  Energies energies_;
  Eigen::VectorXd masses_;               // kg; held particles 1, with no force on them
  Positions y_;
  State now_, before_;                   // of this step, and of the end of the step before
  BlockFactor factor_;
  std::uint32_t gradients_ = 0;          // iterations of the last linear solve
  bool factorised_ = false;
  std::uint64_t newton_steps_ = 0;
};

}  // namespace weft::reference
