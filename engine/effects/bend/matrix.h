// The constant matrix by which bend.comp takes cloth towards where it bends no more than its fabric would.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/fabric.h"

namespace weft::cooking {

/// Row i of the matrix in bend.comp, M_ij without the diagonal as pairs of particle and float bits, when stencils are corrected once a visit:
/// M_ij = sum over stencils e of share_i(e) K_j(e) / D_e. `shares` are (stencil, K_i w_i as float bits) of each particle, `softening` is
/// omega / h^2 (CookState::softening). With `may_pin` the entries that are there do not depend on who is held.
std::vector<std::vector<gpu::uvec2>> bend_matrix(std::span<const std::vector<gpu::uvec2>> shares, const CookedFabric& fabric,
                                                 double softening, bool may_pin);

/// The same of `steps` corrections with masses split, or of fewer where those suffice (matrix.cpp). `inverse_h2`: 1 / solve_step^2, in 1/s^2.
std::vector<std::vector<gpu::uvec2>> bend_matrix_of_steps(std::uint32_t steps, const CookedFabric& fabric, double inverse_h2,
                                                          double relaxation, bool may_pin);

/// A line of a lattice has three; a hinge has four, but for some on slivers whose last counts nothing.
inline int particles_of(const gpu::Bend& bend) { return bend.k[3] == 0 ? 3 : 4; }

}  // namespace weft::cooking
