// Chebyshev's semi-iteration (Golub and Varga 1961) for an implicit step of bending, as one sparse matrix.
//
// The multipliers lambda of that step solve the linear system (alpha~ + K W K^T) lambda = -K x, with alpha~ = alpha / h^2 and W the inverse
// masses. A Jacobi step towards it, with masses split, divides by D_e = sum_j n_j w_j K_j^2 + alpha~_e. So T = D^-1 (alpha~ + K W K^T) has
// its eigenvalues between the least alpha~ / D and 1: n_j stencils share particle j, and K W K^T is no more than the diagonal of these
// sums (Cauchy and Schwarz).
//
// What a smooth fold feels of its rigidity is the part of the smallest eigenvalue that is solved. Fine and stiff cloth has alpha~ / D of a
// few hundredths, as D grows with h^2 B / (rho d^4), d the cells' size: one step leaves it as limp as silk. Steps of the sizes
// 1 / t_k, t_k the roots of Chebyshev's polynomial on [low, 1], leave
//
//     r(t) = prod_k (1 - t / t_k) = T_m((1 + low - 2 t) / (1 - low)) / T_m((1 + low) / (1 - low)),
//
// there no more than a quarter of anything, which is as much as substeps stand (method.cpp). All of them are linear in x, so
// their product is one matrix, and they cost one dispatch with longer rows: of 12, 40, 84 and 144 on a lattice. Its columns are
// found one by one, from what a bump of a metre at one particle does.
#include "engine/effects/bend/matrix.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace weft::cooking {
namespace {

constexpr double kMostLeft = 0.25;     // of a mode: with more than a third, substeps blow up
constexpr double kLittleLeft = 0.05;   // of the smoothest: no more steps than leave that
// Particles that a particle feels, on the mean of a cloth: a lattice has 145 with four steps. Where many triangles share a vertex all of
// their corners would feel each other.
constexpr std::size_t kMostEntries = 256;

// T_m(x) for x >= 1.
double chebyshev(std::uint32_t m, double x) { return std::cosh(m * std::acosh(x)); }

// How far down the interval of m steps reaches that leave kMostLeft of it.
double reach(std::uint32_t m) {
  const double c = std::cosh(std::acosh(1 / kMostLeft) / m);
  return (c - 1) / (c + 1);
}

// As few of `most` steps as leave little of a cloth's smallest eigenvalue.
std::uint32_t steps_for(std::uint32_t most, double least) {
  std::uint32_t m = 1;
  while (m < most && least < 1 && 1 / chebyshev(m, (1 + least) / (1 - least)) > kLittleLeft) ++m;
  return m;
}

// 1 / t_k of m steps for a cloth whose smallest eigenvalue is `least`.
std::vector<double> step_sizes(std::uint32_t m, double least) {
  const double low = std::max(std::min(least, 0.999), reach(m));
  std::vector<double> sizes;
  for (std::uint32_t k = 0; k < m; ++k)
    sizes.push_back(1 / (0.5 * (1 + low) - 0.5 * (1 - low) * std::cos((2 * k + 1) * std::numbers::pi / (2 * m))));
  return sizes;
}

}  // namespace

// Of one step over-relaxation leaves the compliance alone, as of links (CookState::softening).
std::vector<std::vector<gpu::uvec2>> bend_matrix(std::span<const std::vector<gpu::uvec2>> shares, const CookedFabric& fabric,
                                                 double softening, bool may_pin) {
  struct Entry {
    std::uint32_t other;
    double value, size;   // `size` tells whether the entry is there: that may not depend on who is held where the host may pin
  };
  std::vector<std::vector<gpu::uvec2>> rows(shares.size());
  std::vector<Entry> row;
  for (std::uint32_t i = 0; i < shares.size(); ++i) {
    row.clear();
    for (const auto& [e, share] : shares[i]) {
      const gpu::Bend& bend = fabric.bends[e];
      const double part = std::bit_cast<float>(share), scale = part == 0 ? 0 : part / (bend.split_weight + bend.compliance * softening);
      for (int j = 0; j < particles_of(bend); ++j)
        if (bend.particle[j] != i) row.push_back({bend.particle[j], scale * bend.k[j], may_pin ? std::abs(bend.k[j]) : scale * bend.k[j]});
    }
    std::sort(row.begin(), row.end(), [](const Entry& a, const Entry& b) { return a.other < b.other; });
    double largest = 0;
    for (std::size_t k = 0; k < row.size();) {
      Entry sum{row[k].other, 0, 0};
      for (; k < row.size() && row[k].other == sum.other; ++k) sum.value += row[k].value, sum.size += row[k].size;
      largest = std::max(largest, std::abs(sum.size));
      // Entries that cancel but for rounding, as on right angles, are left out.
      if (std::abs(sum.size) > 1e-9 * largest) rows[i].push_back({sum.other, std::bit_cast<std::uint32_t>(static_cast<float>(sum.value))});
    }
  }
  return rows;
}

BendSteps::BendSteps(const CookedFabric& fabric, double inverse_h2, double relaxation, bool may_pin)
    : fabric_(fabric), relaxation_(relaxation), may_pin_(may_pin), stencils_of_(fabric.positions.size()), lambda_(fabric.bends.size()),
      bump_(fabric.positions.size()) {
  for (std::uint32_t e = 0; e < fabric.bends.size(); ++e) {
    const gpu::Bend& bend = fabric.bends[e];
    softness_.push_back(bend.compliance * inverse_h2);
    // One without an area, all of it held, has neither softness nor weight: it takes no steps.
    const double whole = bend.split_weight + softness_.back();
    inverse_.push_back(whole > 0 ? 1 / whole : 0);
    for (int c = 0; c < particles_of(bend); ++c) stencils_of_[bend.particle[c]].push_back(e);
  }
}

bool BendSteps::add(std::uint32_t most, const ClothRange& cloth, std::vector<std::vector<gpu::uvec2>>& rows) {
  const std::uint32_t end = cloth.first_particle + cloth.particles;
  double least = 1;
  for (std::uint32_t i = cloth.first_particle; i < end; ++i)
    for (const std::uint32_t e : stencils_of_[i]) least = std::min(least, softness_[e] * inverse_[e]);
  const std::uint32_t wanted = steps_for(most, least);
  std::uint32_t steps = wanted;
  while (!try_to_add(step_sizes(steps, least), cloth, rows)) {
    for (std::uint32_t i = cloth.first_particle; i < end; ++i) rows[i].clear();
    --steps;
  }
  return steps == wanted;
}

// False where the rows would be too long; never with one step.
bool BendSteps::try_to_add(std::span<const double> sizes, const ClothRange& cloth, std::vector<std::vector<gpu::uvec2>>& rows) {
  const std::span<const gpu::Bend> bends = fabric_.bends;
  std::size_t entries = 0;
  for (std::uint32_t j = cloth.first_particle; j < cloth.first_particle + cloth.particles; ++j) {
    lambda_.clear(), bump_.clear();
    bump_[j] = 1;
    for (const double size : sizes) {
      // x + W K^T lambda as it is now; every stencil that it touches takes its step from there.
      for (const std::uint32_t i : bump_.touched)
        for (const std::uint32_t e : stencils_of_[i]) lambda_[e];
      for (const std::uint32_t e : lambda_.touched) {
        double l = softness_[e] * lambda_.value[e];
        for (int c = 0; c < particles_of(bends[e]); ++c) l += bends[e].k[c] * bump_.value[bends[e].particle[c]];
        lambda_.value[e] -= size * l * inverse_[e];
      }
      bump_.clear();
      bump_[j] = 1;
      for (const std::uint32_t e : lambda_.touched)
        for (int c = 0; c < particles_of(bends[e]); ++c) {
          const std::uint32_t i = bends[e].particle[c];
          bump_[i] += fabric_.positions[i].w * bends[e].k[c] * lambda_.value[e];
        }
    }
    entries += bump_.touched.size();
    if (sizes.size() > 1 && entries > kMostEntries * cloth.particles) return false;
    double largest = 0;
    for (const std::uint32_t i : bump_.touched)
      if (i != j) largest = std::max(largest, std::abs(bump_.value[i]));
    for (const std::uint32_t i : bump_.touched) {
      // Nothing moves what is held. Where the host may pin, though, its row is there.
      if (i == j || !(may_pin_ || (fabric_.positions[i].w > 0 && std::abs(bump_.value[i]) > 1e-9 * largest))) continue;
      rows[i].push_back({j, std::bit_cast<std::uint32_t>(static_cast<float>(-bump_.value[i] / relaxation_))});
    }
  }
  return true;
}

}  // namespace weft::cooking
