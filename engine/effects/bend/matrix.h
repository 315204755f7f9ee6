// The constant matrix by which bend.comp takes cloth towards where it bends no more than its fabric would.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/fabric.h"

namespace weft::cooking {

/// Row i of the matrix in bend.comp, M_ij without the diagonal as pairs of particle and float bits, when stencils are corrected once a
/// visit: M_ij = sum over stencils e of share_i(e) K_j(e) / D_e. `shares` are (stencil, K_i w_i as float bits) of each particle, `softening` is
/// omega / h^2 (CookState::softening). With `may_pin` the entries that are there do not depend on who is held.
std::vector<std::vector<gpu::uvec2>> bend_matrix(std::span<const std::vector<gpu::uvec2>> shares, const CookedFabric& fabric,
                                                 double softening, bool may_pin);

/// Rows of the same matrix, cloth by cloth, when stencils are corrected several times a visit, with masses split.
class BendSteps {
 public:
  /// `inverse_h2`: 1 / solve_step^2, in 1/s^2.
  BendSteps(const CookedFabric& fabric, double inverse_h2, double relaxation, bool may_pin);

  /// Adds the rows of a cloth, which are empty, for `most` steps or fewer where those suffice. False where those would
  /// make rows too long, and it took fewer.
  bool add(std::uint32_t most, const ClothRange& cloth, std::vector<std::vector<gpu::uvec2>>& rows);

 private:
  // Numbers by stencil or particle of which few are not zero. Those that were touched are in it whatever their value is.
  struct Sparse {
    explicit Sparse(std::size_t size) : value(size), in(size) {}
    double& operator[](std::uint32_t k) {
      if (!in[k]) in[k] = true, touched.push_back(k);
      return value[k];
    }
    void clear() {
      for (const std::uint32_t k : touched) value[k] = 0, in[k] = false;
      touched.clear();
    }
    std::vector<double> value;
    std::vector<bool> in;
    std::vector<std::uint32_t> touched;
  };

  bool try_to_add(std::span<const double> sizes, const ClothRange& cloth, std::vector<std::vector<gpu::uvec2>>& rows);

  const CookedFabric& fabric_;
  double relaxation_;
  bool may_pin_;
  std::vector<double> softness_, inverse_;                  // stencils: alpha~ and 1 / D
  std::vector<std::vector<std::uint32_t>> stencils_of_;     // of each particle
  Sparse lambda_, bump_;                                    // of stencils and of particles, while a column is found
};

/// A line of a lattice has three; a hinge has four, but for some on slivers whose last counts nothing.
inline int particles_of(const gpu::Bend& bend) { return bend.k[3] == 0 ? 3 : 4; }

}  // namespace weft::cooking
