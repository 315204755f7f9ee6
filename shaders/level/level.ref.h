// Twin of the passes level_low, level_wide and level_spread: before an iteration, a pull is carried over coarse levels of nodes, coarsest
// first; each node goes where the next coarser level carries it and then as its links ask, as by one iteration of relax_stretch. After:
// Mueller 2008, "Hierarchical position based dynamics"; the shares are those of Weft.
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
  std::vector<std::uint32_t> particles;   // of each node: where it is
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

/// How far the nodes of a level go, `coarser` being how far those of the next coarser level went. `lambda`: one a link, renewed.
inline Points level_steps(const Level& level, const Points& particles, const Points& coarser, std::span<double> lambda, double h, double omega) {
  Points p;
  for (std::size_t k = 0; k < level.particles.size(); ++k) {
    p.push_back(particles[level.particles[k]]);
    if (level.inverse_masses[k] > 0 && !level.shares.empty()) p.back() += carried(level.shares[k], coarser);
  }
  std::uint32_t coincident = 0;
  Points steps = relax_stretch(level.links, p, level.inverse_masses, lambda, h, omega, Averaged::mass_split, coincident);
  for (std::size_t k = 0; k < steps.size(); ++k) steps[k] -= particles[level.particles[k]];
  return steps;
}

}  // namespace weft::reference
