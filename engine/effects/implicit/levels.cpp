// How stiff a level's node is against the mean of the blocks of what it carries (shaders/implicit/mean.glsl).
//
// The diagonal block of P^T K P is the sum over springs of (w_a - w_b)^2 times a spring's block, w the shares of its ends in the node. In
// cloth at rest one number tells enough of it: its trace over that of the mean of the blocks of particles, each the sum of its springs'.
// Held particles have no share. Springs of rest length 0 bend (of either sign), and are left out.
#include "engine/effects/implicit/levels.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/effects/implicit/implicit.h"
#include "shaders/packed.h"

namespace weft::effects {
namespace {

using Shares = std::vector<std::pair<std::uint32_t, double>>;   // nodes and shares, by node

void add(Shares& shares, std::uint32_t node, double share) {
  const auto at = std::ranges::lower_bound(shares, node, {}, &Shares::value_type::first);
  if (at != shares.end() && at->first == node) at->second += share;
  else if (share != 0) shares.insert(at, {node, share});
}

void add(Shares& shares, const gpu::uvec4& packed, double part) {
  if (packed.x == WEFT_NONE) return;
  const gpu::LevelShare share = gpu::unpack_level_share(packed);
  add(shares, share.node0, part * double(share.part0));
  add(shares, share.node1, part * double(share.part1));
  add(shares, share.node2, part * double(share.part2));
}

// From the shares in one level to those in the next coarser one.
Shares coarser(const Shares& shares, const LevelLists& lists) {
  Shares made;
  for (const auto& [node, share] : shares) add(made, lists.node_shares[node], share);
  return made;
}

// Of node k: the mean of what it gathers.
double mean_of(const LevelLists& lists, std::uint32_t k, const std::vector<double>& values) {
  const std::uint32_t begin = gpu::unpack_level_node(lists.nodes[k]).first_gather;
  const std::uint32_t end = gpu::unpack_level_node(lists.nodes[k + 1]).first_gather;
  const double from = values[gpu::unpack_level_gather(lists.gathers[begin]).point];
  double mean = from;
  for (std::uint32_t g = begin + 1; g < end; ++g) {
    const gpu::LevelGather gather = gpu::unpack_level_gather(lists.gathers[g]);
    mean += double(gather.in_centre) * (values[gather.point] - from);
  }
  return mean;
}

// Adds what springs are to the nodes in which their ends have unequal shares.
void add_stiffness(const std::vector<ParticleSpring>& springs, const std::vector<Shares>& shares, std::vector<double>& of_nodes) {
  Shares differences;
  for (const ParticleSpring& spring : springs) {
    if (spring.rest == 0) continue;
    differences = shares[spring.a];
    for (const auto& [node, share] : shares[spring.b]) add(differences, node, -share);
    for (const auto& [node, difference] : differences) of_nodes[node] += double(spring.stiffness) * difference * difference;
  }
}

}  // namespace

void grip_levels(cooking::CookState& state) {
  if (state.scene().solver.method != Method::implicit) return;
  CookedFabric& fabric = state.fabric();
  const LevelLists& lists = fabric.own.of<LevelLists>();
  std::vector<float>& grips = fabric.own.of<ImplicitLevels>().grips;
  grips.assign(lists.nodes.size(), -1);
  std::vector<double> finer(fabric.positions.size());   // N/m: the trace of a particle's block, then of a node's mean block
  for (const ParticleSpring& spring : fabric.springs)
    if (spring.rest > 0) finer[spring.a] += double(spring.stiffness), finer[spring.b] += double(spring.stiffness);
  std::vector<Shares> shares(fabric.positions.size());
  for (std::size_t i = 0; i < shares.size() && !lists.ends.empty(); ++i) add(shares[i], lists.shares[i], 1);
  std::vector<double> own(lists.nodes.size()), mean(lists.nodes.size());
  for (std::size_t level = lists.ends.size(); level-- > 0;) {
    add_stiffness(fabric.springs, shares, own);
    for (std::uint32_t k = level == 0 ? 0 : lists.ends[level - 1]; k < lists.ends[level]; ++k) {
      mean[k] = mean_of(lists, k, finer);
      const double inverse_mass = double(gpu::unpack_level_node(lists.nodes[k]).inverse_mass);
      if (inverse_mass > 0) grips[k] = mean[k] > 0 ? static_cast<float>(own[k] / mean[k] * inverse_mass) : 0.0f;
    }
    finer = mean;
    for (Shares& share : shares) share = coarser(share, lists);
  }
}

}  // namespace weft::effects
