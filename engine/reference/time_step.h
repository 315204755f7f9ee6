// One time step as a problem to be solved: find the displacement u from the free motion y, and the multipliers lambda, with
//
//     M u = sum grad C lambda - sum K k l          no force is left over
//     C + (alpha / h^2) lambda = 0                 every link pulls as hard as its compliance says
//     lambda <= 0 for links that only pull, and 0 where they are slack
//
// which are the stationary points of the incremental potential 1/2 |u|_M^2 + h^2 E(y + u) (Macklin et al. 2016, eq. 8 and 9,
// without dropping any term). Multipliers are unknowns of their own: a stiff link's C is a small difference of large lengths, and
// a potential made of it alone would turn rounding into force.
//
// A Newton step eliminates the multipliers (their block is diagonal), which leaves a symmetric system in the particles,
//
//     (M + sum K k K^T - sum lambda grad^2 C + sum grad C (h^2 / alpha) grad C^T) du = -(what is left over),
//
// solved by conjugate gradients, preconditioned with the sparse Cholesky factor of its stiff part between neighbours in the mesh
// and of the diagonal of the rest. Links of eight edges would fill that factor a hundredfold, and without them the condition stays
// small (energies.h says why). The factor is kept, over time steps too, until the gradients need too long with it.
#pragma once

#include "engine/reference/block_factor.h"
#include "engine/reference/energies.h"

namespace weft::reference {

class TimeStep {
 public:
  explicit TimeStep(Energies energies);

  /// The next step, from the free motion y (m). Displacements and multipliers are guessed to be those of the step before, or to go on
  /// changing as they did.
  void begin(const Positions& free_motion);
  /// Newton, until what is left over is at most `tolerance` times `scale` (m) or times the largest displacement. False: it is more.
  bool solve(double tolerance, double scale, std::uint32_t most_steps);

  const Positions& displacement() const { return now_.u; }
  std::uint64_t newton_steps() const { return newton_steps_; }

 private:
  struct State {
    Positions u;                         // m
    Eigen::VectorXd lambda;              // kg m
  };
  // What a link looks like in a state.
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
  // Conjugate gradients; false where a direction of negative curvature turned up.
  bool solve_linear(const Residual& at, const Eigen::VectorXd& lambda, const Positions& rhs, bool projected, double enough, Positions& du);

  Energies energies_;
  Eigen::VectorXd masses_;               // kg; held particles 1, with no force on them
  Positions y_;
  State now_, before_;                   // this step's, and the end of the one before
  BlockFactor factor_;
  std::uint32_t gradients_ = 0;          // that the last linear solve took
  bool factorised_ = false;
  std::uint64_t newton_steps_ = 0;
};

}  // namespace weft::reference
