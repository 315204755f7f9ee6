// A stabilised step of bending (Runge-Kutta-Chebyshev: van der Houwen and Sommeijer 1980), as one sparse matrix.
//
// Bending is linear. In a step h its forces move places by -L x, with L = W K^T C^-1 K: W the inverse masses, K the stencils, C their
// compliances alpha / h^2. x - L x is right for smooth folds and blows up where L has eigenvalues above 4/3, as substeps stand no less
// than -1/3 of a mode (method.cpp). A polynomial of m such steps has the same slope at zero, so that smooth folds feel the whole of
// their rigidity, and leaves no more than a quarter of anything else, up to l = b_m:
//
//     p(l) = T_m(c - l T_m(c) / T_m'(c)) / T_m(c) = prod_k (1 - l / l_k),   T_m(c) = 4,   b_m = (c + 1) T_m'(c) / T_m(c),
//
// T_m Chebyshev's polynomial. b_m is 1.25, 4.1, 8.8 and 15.3 for one to four steps. What is finer and stiffer than that is softened: the
// eigenvalues are below the largest of sum_j n_j w_j K_j^2 / C over the stencils, n_j of which share particle j (Cauchy and Schwarz), so
// that C is made no less than sum_j n_j w_j K_j^2 / b_m, stencil by stencil. L grows with h^2 B / (rho d^4), d the cells' size.
//
// The product is one matrix and costs one dispatch, with longer rows: of 12, 40, 84 and 144 entries on a lattice. Its columns are found one
// by one, from what a bump of a metre at one particle does.
#include "engine/effects/bend/matrix.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace weft::cooking {
namespace {

constexpr double kMostLeft = 0.25;     // of a mode: with more than a third, substeps blow up
constexpr double kStiffEnough = 0.95;  // mean part of the rigidity that a cloth feels: no more steps than give that
// Particles that a particle feels, on the mean of a cloth: a lattice has 145 with four steps. Where many triangles share a vertex all of
// their corners would feel each other.
constexpr std::size_t kMostEntries = 256;

// c of m steps is cosh of this.
double reach(std::uint32_t m) { return std::acosh(1 / kMostLeft) / m; }

// T_m'(c) / T_m(c).
double slope(std::uint32_t m) { return m * std::tanh(m * reach(m)) / std::sinh(reach(m)); }

// b_m.
double largest(std::uint32_t m) { return (std::cosh(reach(m)) + 1) * slope(m); }

// 1 / l_k.
std::vector<double> step_sizes(std::uint32_t m) {
  std::vector<double> sizes;
  for (std::uint32_t k = 0; k < m; ++k)
    sizes.push_back(1 / (slope(m) * (std::cosh(reach(m)) - std::cos((2 * k + 1) * std::numbers::pi / (2 * m)))));
  return sizes;
}

}  // namespace

BendSteps::BendSteps(const CookedFabric& fabric, double h, bool may_pin)
    : fabric_(fabric), may_pin_(may_pin), stencils_of_(fabric.positions.size()), force_(fabric.bends.size()), bump_(fabric.positions.size()) {
  for (std::uint32_t e = 0; e < fabric.bends.size(); ++e)
    for (int c = 0; c < particles_of(fabric.bends[e]); ++c) stencils_of_[fabric.bends[e].particle[c]].push_back(e);
  for (const gpu::Bend& bend : fabric.bends) {
    double weight = 0;
    for (int c = 0; c < particles_of(bend); ++c)
      weight += static_cast<double>(stencils_of_[bend.particle[c]].size()) * fabric.positions[bend.particle[c]].w * bend.k[c] * bend.k[c];
    weight_.push_back(weight);
    compliance_.push_back(bend.compliance / (h * h));
  }
}

// As few of `most` as make it stiff enough.
std::uint32_t BendSteps::steps_for(std::uint32_t most, const ClothRange& cloth) const {
  std::vector<double> eigenvalues;   // of the free
  for (std::uint32_t i = cloth.first_particle; i < cloth.first_particle + cloth.particles; ++i)
    for (const std::uint32_t e : stencils_of_[i])
      if (weight_[e] > 0) eigenvalues.push_back(weight_[e] / compliance_[e]);
  std::uint32_t m = 1;
  for (; m < most; ++m) {
    double felt = 0;
    for (const double l : eigenvalues) felt += std::min(1.0, largest(m) / l);
    if (felt >= kStiffEnough * static_cast<double>(eigenvalues.size())) break;
  }
  return m;
}

bool BendSteps::add(std::uint32_t most, const ClothRange& cloth, std::vector<std::vector<gpu::uvec2>>& rows) {
  const std::uint32_t wanted = steps_for(most, cloth);
  std::uint32_t steps = wanted;
  while (!try_to_add(steps, cloth, rows)) {
    for (std::uint32_t i = cloth.first_particle; i < cloth.first_particle + cloth.particles; ++i) rows[i].clear();
    --steps;
  }
  return steps == wanted;
}

// False where the rows would be too long; never with one step.
bool BendSteps::try_to_add(std::uint32_t steps, const ClothRange& cloth, std::vector<std::vector<gpu::uvec2>>& rows) {
  const std::span<const gpu::Bend> bends = fabric_.bends;
  const std::vector<double> sizes = step_sizes(steps);
  const double most = largest(steps);
  std::size_t entries = 0;
  for (std::uint32_t j = cloth.first_particle; j < cloth.first_particle + cloth.particles; ++j) {
    bump_.clear();
    bump_[j] = 1;
    for (const double size : sizes) {
      force_.clear();
      for (const std::uint32_t i : bump_.touched)
        for (const std::uint32_t e : stencils_of_[i]) force_[e];
      for (const std::uint32_t e : force_.touched) {
        double bent = 0;
        for (int c = 0; c < particles_of(bends[e]); ++c) bent += bends[e].k[c] * bump_.value[bends[e].particle[c]];
        // One without an area, all of it held, has neither compliance nor weight.
        const double compliance = std::max(compliance_[e], weight_[e] / most);
        if (compliance > 0) force_.value[e] = -size * bent / compliance;
      }
      for (const std::uint32_t e : force_.touched)
        for (int c = 0; c < particles_of(bends[e]); ++c) {
          const std::uint32_t i = bends[e].particle[c];
          bump_[i] += fabric_.positions[i].w * bends[e].k[c] * force_.value[e];
        }
    }
    entries += bump_.touched.size();
    if (steps > 1 && entries > kMostEntries * cloth.particles) return false;
    double greatest = 0;
    for (const std::uint32_t i : bump_.touched)
      if (i != j) greatest = std::max(greatest, std::abs(bump_.value[i]));
    for (const std::uint32_t i : bump_.touched) {
      // Nothing moves what is held. Entries that cancel but for rounding, as on right angles, are left out. Where the host may pin, though,
      // all of them are there.
      if (i == j || !(may_pin_ || (fabric_.positions[i].w > 0 && std::abs(bump_.value[i]) > 1e-9 * greatest))) continue;
      rows[i].push_back({j, std::bit_cast<std::uint32_t>(static_cast<float>(-bump_.value[i]))});
    }
  }
  return true;
}

}  // namespace weft::cooking
