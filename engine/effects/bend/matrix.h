// The constant matrix by which bend.comp takes cloth towards where it bends no more than its fabric would.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/fabric.h"

namespace weft::cooking {

/// Its rows, cloth by cloth: what a visit takes off a particle's place is sum_j M_ij (p_j - p_i).
class BendSteps {
 public:
  /// `h`: solve_step, in s. With `may_pin` the entries that are there do not depend on who is held.
  BendSteps(const CookedFabric& fabric, double h, bool may_pin);

  /// Adds the rows of a cloth, which are empty: M_ij without the diagonal as pairs of particle and float bits. Takes `most` steps (1 to 4), or
  /// fewer where those suffice. False where those would make rows too long, and it took fewer.
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

  std::uint32_t steps_for(std::uint32_t most, const ClothRange& cloth) const;
  bool try_to_add(std::uint32_t steps, const ClothRange& cloth, std::vector<std::vector<gpu::uvec2>>& rows);

  const CookedFabric& fabric_;
  bool may_pin_;
  std::vector<double> weight_, compliance_;                 // of stencils: the weight of split masses, and alpha / h^2
  std::vector<std::vector<std::uint32_t>> stencils_of_;     // of each particle
  Sparse force_, bump_;                                     // of stencils and of particles, while a column is found
};

/// A line of a lattice has three; a hinge has four, but for some on slivers whose last counts nothing.
inline int particles_of(const gpu::Bend& bend) { return bend.k[3] == 0 ? 3 : 4; }

}  // namespace weft::cooking
