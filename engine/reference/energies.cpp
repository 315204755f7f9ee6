#include "engine/reference/energies.h"

#include <algorithm>
#include <cmath>

namespace weft::reference {
namespace {

// Relative error of a packed rest length (shared.h, Link).
constexpr double kPacking = 0x1p-17;

// An energy is stiff that resists its particles this many times more than their masses do. Below that, conjugate gradients are as
// fast without a factor (measured on 33 x 33 and 100 x 100 particles of cotton, at h and h / 16).
constexpr double kStiff = 1000;

Preconditioned part(bool stiff, bool neighbours) {
  if (!stiff) return Preconditioned::diagonal;
  return neighbours ? Preconditioned::whole : Preconditioned::left_out;
}

// Tells edges from links of several edges, by their lengths relative to the shortest two-sided link beside them.
class Neighbourhood {
 public:
  explicit Neighbourhood(const CookedFabric& fabric) : shortest_(fabric.positions.size(), INFINITY), longest_(fabric.positions.size(), 0) {
    for (const StretchLink& link : fabric.links) {
      if (link.only_pulls) continue;
      for (const std::uint32_t end : {link.a, link.b}) {
        shortest_[end] = std::min(shortest_[end], double(link.rest));
        longest_[end] = std::max(longest_[end], double(link.rest));
      }
    }
  }
  /// How many edges a link spans, at least 1.
  double edges(const StretchLink& link) const {
    const double shortest = std::min(shortest_[link.a], shortest_[link.b]);
    return std::isfinite(shortest) ? std::max(1.0, link.rest / shortest) : 1;
  }
  /// Whether it is about as long as an edge.
  bool neighbours(const StretchLink& link) const {
    return !link.only_pulls || link.rest <= 2 * std::max(longest_[link.a], longest_[link.b]);
  }

 private:
  std::vector<double> shortest_, longest_;   // m, two-sided links at each particle
};

// The rest length before packing, where the cooked pose has it (m).
double rest_length(const CookedFabric& fabric, const StretchLink& link) {
  const gpu::vec4 &a = fabric.positions[link.a], &b = fabric.positions[link.b];
  const double cooked = std::hypot(double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z);
  return std::abs(cooked - link.rest) <= kPacking * link.rest ? cooked : link.rest;
}

}  // namespace

Energies energies_of(const CookedFabric& fabric, double h) {
  Energies energies;
  const std::size_t particles = fabric.positions.size();
  energies.inverse_masses.resize(static_cast<Eigen::Index>(particles));
  for (std::size_t i = 0; i < particles; ++i) energies.inverse_masses[static_cast<Eigen::Index>(i)] = fabric.positions[i].w;
  const auto add = [&](std::uint32_t a, std::uint32_t b, double rest, double compliance, double edges, bool only_pulls, bool neighbours) {
    const double weight = energies.inverse_masses[a] + energies.inverse_masses[b];
    const double softness = std::max(compliance / (h * h), kSoftening * weight * edges * edges);
    if (weight > 0) energies.links.push_back({a, b, rest, softness, weight, only_pulls, part(weight > kStiff * softness, neighbours)});
  };
  const Neighbourhood neighbourhood(fabric);
  for (const StretchLink& link : fabric.links)
    add(link.a, link.b, rest_length(fabric, link), link.compliance, neighbourhood.edges(link), link.only_pulls,
        neighbourhood.neighbours(link) || energies.inverse_masses[link.a] * energies.inverse_masses[link.b] == 0);
  for (std::size_t k = 0; k < fabric.tethers.size(); ++k)
    if (const gpu::Tether& tether = fabric.tethers[k]; tether.anchor != WEFT_NONE)
      add(static_cast<std::uint32_t>(k / fabric.tethers_per_particle), tether.anchor, tether.max_distance, 0, 1, true, true);
  for (const gpu::Bend& bend : fabric.bends) {
    const double k1 = bend.k[1], k2 = bend.k[2], k3 = bend.k[3];
    BendEnergy energy{{bend.particle[0], bend.particle[1], bend.particle[2], bend.particle[3]},
                      {-(k1 + k2 + k3), k1, k2, k3},
                      0,
                      Preconditioned::diagonal};
    double weight = 0;
    for (int j = 0; j < 4; ++j) weight += energies.inverse_masses[energy.particle[j]] * energy.k[j] * energy.k[j];
    energy.stiffness = 1 / std::max(bend.compliance / (h * h), kSoftening * weight);
    energy.part = part(energy.stiffness * weight > kStiff, true);
    if (weight > 0) energies.bends.push_back(energy);
  }
  return energies;
}

}  // namespace weft::reference
