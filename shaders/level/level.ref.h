// Twin of the passes of coarse levels: before an iteration, a pull is carried over levels of nodes, coarsest first; each node, the centre of
// mass of what it carries, goes where the next coarser level carries it and then as its links ask, as by one iteration of relax_stretch.
// After: Mueller 2008, "Hierarchical position based dynamics"; the shares and centres are those of Weft.
#pragma once

#include <array>

#include "shaders/stretch/stretch.ref.h"

namespace weft::reference {

/// What nodes have in a displacement; unused places have a part of 0.
struct Share {
  std::array<std::uint32_t, 3> node{};
  std::array<double, 3> part{};
};

struct Level {
  std::vector<std::vector<std::pair<std::uint32_t, double>>> gathers;   // of each node: points of the finer level, and weights that sum to 1
  std::vector<double> inverse_masses;     // 1/kg; 0: held
  std::vector<Share> shares;              // of each node in those of the next coarser level; empty: there is none
  std::vector<Stretch> links;             // between nodes; they only pull
};

/// m
inline Vector carried(const Share& share, const Points& steps) {
  Vector sum = Vector::Zero();
  for (int k = 0; k < 3; ++k)
    if (share.part[k] != 0) sum += share.part[k] * steps[share.node[k]];
  return sum;
}

/// The centres of a level's nodes (m), `finer` being those of the next finer level, or the particles.
inline Points centres(const Level& level, const Points& finer) {
  Points centres;
  for (const auto& gathers : level.gathers) {
    Vector& sum = centres.emplace_back(Vector::Zero());
    for (const auto& [point, weight] : gathers) sum += weight * finer[point];
  }
  return centres;
}

/// How far the nodes of a level go from their `centres`, `coarser` being how far those of the next coarser level went. `lambda`: one a link, renewed.
inline Points level_steps(const Level& level, const Points& centres, const Points& coarser, std::span<double> lambda, double h, double omega) {
  Points p = centres;
  for (std::size_t k = 0; k < p.size(); ++k)
    if (level.inverse_masses[k] > 0 && !level.shares.empty()) p[k] += carried(level.shares[k], coarser);
  std::uint32_t coincident = 0;
  Points steps = relax_stretch(level.links, p, level.inverse_masses, lambda, h, omega, Averaged::mass_split, coincident);
  for (std::size_t k = 0; k < steps.size(); ++k) steps[k] -= centres[k];
  return steps;
}

}  // namespace weft::reference
