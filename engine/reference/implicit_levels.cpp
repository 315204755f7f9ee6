#include "engine/reference/implicit_levels.h"

#include <Eigen/Cholesky>

#include "engine/effects/implicit/implicit.h"
#include "shaders/packed.h"

namespace weft::reference {
namespace {

template <typename Shares>
Shares unpacked(const gpu::uvec4& packed) {
  if (packed.x == WEFT_NONE) return {};
  const gpu::LevelShare share = gpu::unpack_level_share(packed);
  return {{share.node0, double(share.part0)}, {share.node1, double(share.part1)}, {share.node2, double(share.part2)}};
}

}  // namespace

std::shared_ptr<const ImplicitLevels> ImplicitLevels::create(const CookedFabric& fabric) {
  const LevelLists& lists = fabric.own.of<LevelLists>();
  if (lists.ends.empty()) return nullptr;
  auto made = std::make_shared<ImplicitLevels>();
  for (std::size_t k = 0; k + 1 < lists.nodes.size(); ++k) {
    Node node{{}, unpacked<Shares>(lists.node_shares[k]), double(fabric.own.of<weft::ImplicitLevels>().grips[k])};
    double left = 1;   // the first gather has what the others leave
    const std::uint32_t begin = gpu::unpack_level_node(lists.nodes[k]).first_gather;
    const std::uint32_t end = gpu::unpack_level_node(lists.nodes[k + 1]).first_gather;
    for (std::uint32_t g = begin; g < end; ++g) {
      const gpu::LevelGather gather = gpu::unpack_level_gather(lists.gathers[g]);
      node.gathers.push_back({gather.point, g == begin ? 0 : double(gather.in_centre)});
      left -= node.gathers.back().weight;
    }
    node.gathers.front().weight = left;
    made->nodes_.push_back(std::move(node));
  }
  made->finest_ = lists.ends.size() < 2 ? 0 : lists.ends[lists.ends.size() - 2];
  made->inverse_masses_.resize(static_cast<Eigen::Index>(fabric.positions.size()));
  for (std::size_t i = 0; i < fabric.positions.size(); ++i) {
    made->shares_.push_back(unpacked<Shares>(lists.shares[i]));
    made->inverse_masses_[static_cast<Eigen::Index>(i)] = double(fabric.positions[i].w);
  }
  return made;
}

// Finer levels come later, so theirs are made first.
template <typename Value>
std::vector<Value> ImplicitLevels::means(const std::vector<Value>& of_particles) const {
  std::vector<Value> of_nodes(nodes_.size(), Value::Zero());
  for (std::size_t k = nodes_.size(); k-- > 0;)
    for (const Gather& gather : nodes_[k].gathers)
      of_nodes[k] += gather.weight * (k >= finest_ ? of_particles : of_nodes)[gather.point];
  return of_nodes;
}

template std::vector<Matrix> ImplicitLevels::means(const std::vector<Matrix>&) const;

Eigen::Matrix3Xd ImplicitLevels::changes(const Eigen::Matrix3Xd& residual, const Blocks& of_nodes) const {
  std::vector<Vector> of_particles;
  for (Eigen::Index i = 0; i < residual.cols(); ++i) of_particles.push_back(inverse_masses_[i] * residual.col(i));
  const std::vector<Vector> mean = means(of_particles);
  std::vector<Vector> change(nodes_.size(), Vector::Zero());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Matrix block = Matrix::Identity() + nodes_[k].grip * of_nodes.springs[k] + of_nodes.held[k];
    if (nodes_[k].grip >= 0) change[k] = double(WEFT_LEVEL_PART) * block.ldlt().solve(mean[k]);
    for (const Share& share : nodes_[k].shares) change[k] += share.part * change[share.node];
  }
  Eigen::Matrix3Xd spread = Eigen::Matrix3Xd::Zero(3, residual.cols());
  for (Eigen::Index i = 0; i < residual.cols(); ++i)
    for (const Share& share : shares_[static_cast<std::size_t>(i)]) spread.col(i) += share.part * change[share.node];
  return spread;
}

}  // namespace weft::reference
