// Twin of the passes of coarse levels: before an iteration, a pull is carried over levels of nodes, coarsest first; each node goes where the
// next coarser level carries it and then as its links ask, as by one iteration of relax_stretch with masses split. Links are as long as the
// middles of nodes are apart, and pull at the centres of mass of what the nodes carry.
// After: Mueller 2008, "Hierarchical position based dynamics"; the shares and centres are those of Weft.
#pragma once

#include <algorithm>
#include <array>

#include "shaders/stretch/stretch.ref.h"

namespace weft::reference {

/// What nodes have in a displacement; unused places have a part of 0.
struct Share {
  std::array<std::uint32_t, 3> node{};
  std::array<double, 3> part{};
};

/// A point of the finer level as a node has it.
struct Gather {
  std::uint32_t point;
  double in_centre, in_middle;
};

struct Level {
  std::vector<std::vector<Gather>> gathers;   // of each node, of the finer level; both weights sum to 1
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

/// The centres or the middles of a level's nodes (m), `finer` being those of the next finer level, or the particles.
inline Points means(const Level& level, const Points& finer, double Gather::*weight) {
  Points means;
  for (const auto& gathers : level.gathers) {
    Vector& sum = means.emplace_back(Vector::Zero());
    for (const Gather& gather : gathers) sum += gather.*weight * finer[gather.point];
  }
  return means;
}

/// What nodes' shares carry of what was held of their steps.
inline double carried_held(const Share& share, std::span<const double> held) {
  double sum = 0;
  for (int k = 0; k < 3; ++k)
    if (share.part[k] != 0) sum += share.part[k] * held[share.node[k]];
  return sum;
}

/// How far the nodes of a level go, `coarser` being how far those of the next coarser level went. `lambda`: one a link, renewed.
/// `kept`: of its length, what this leaves of a link at least. `supports`: of the nodes; `coarser_held`: Supports::held of the coarser level.
inline Points level_steps(const Level& level, const Points& centres, const Points& middles, const Points& coarser, std::span<double> lambda,
                          double h, double omega, double kept, Supports* supports = nullptr, std::span<const double> coarser_held = {}) {
  const std::size_t nodes = level.inverse_masses.size();
  Points gone(nodes, Vector::Zero()), sums(nodes, Vector::Zero());
  for (std::size_t k = 0; k < nodes; ++k)
    if (level.inverse_masses[k] > 0 && !level.shares.empty()) gone[k] = carried(level.shares[k], coarser);
  const Points freely = gone;
  for (std::size_t k = 0; k < nodes && supports; ++k) gone[k] = supports->yields(k, gone[k]);
  std::vector<double> split(level.inverse_masses);
  std::vector<int> links(nodes);
  for (const Stretch& link : level.links) ++links[link.a], ++links[link.b];
  for (std::size_t k = 0; k < nodes; ++k) split[k] *= links[k];
  for (std::size_t l = 0; l < level.links.size(); ++l) {
    const auto& [a, b, rest, compliance, only_pulls] = level.links[l];
    const Vector d = middles[a] + gone[a] - middles[b] - gone[b], pull = centres[a] + gone[a] - centres[b] - gone[b];
    const double alpha = compliance / (h * h);
    const double too_long = d.norm() - std::max(rest, kept * d.norm());
    const double change = std::min(-omega * (too_long + alpha * lambda[l]) / (split[a] + split[b] + omega * alpha), -lambda[l]);
    lambda[l] += change;
    sums[a] += change * pull.normalized();
    sums[b] -= change * pull.normalized();
  }
  for (std::size_t k = 0; k < nodes; ++k) {
    gone[k] += level.inverse_masses[k] * sums[k];
    if (!supports || level.inverse_masses[k] == 0) continue;
    const Vector asked = freely[k] + level.inverse_masses[k] * sums[k];
    gone[k] = supports->yields(k, asked);
    supports->held[k] = (level.shares.empty() ? 0 : carried_held(level.shares[k], coarser_held)) +
                        supports->held_of(k, asked) / std::max(supports->put_out[k].norm(), 1e-9);
  }
  return gone;
}

}  // namespace weft::reference
