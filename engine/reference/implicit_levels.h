// Coarse levels as a preconditioner of the implicit system, as shaders/implicit/mean.glsl has them, in double precision.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/fabric.h"
#include "shaders/implicit/implicit.ref.h"

namespace weft::reference {

class ImplicitLevels {
 public:
  /// Null where the fabric has no levels.
  static std::shared_ptr<const ImplicitLevels> create(const CookedFabric& fabric);

  /// What a node's block is made of: the mean of what springs are to what it carries (kg), and of what colliders are to it.
  struct Blocks {
    std::vector<Matrix> springs, held;
  };
  /// One a node, from one a particle.
  Blocks means_of(const Blocks& of_particles) const { return {means(of_particles.springs), means(of_particles.held)}; }
  /// By how much particles go with the nodes (m/s), not filtered, for a residual (kg m/s). One column a particle.
  Eigen::Matrix3Xd changes(const Eigen::Matrix3Xd& residual, const Blocks& of_nodes) const;

 private:
  struct Gather {
    std::uint32_t point;
    double weight;
  };
  struct Share {
    std::uint32_t node;
    double part;
  };
  using Shares = std::vector<Share>;   // of one point; empty: it stays
  struct Node {
    std::vector<Gather> gathers;       // weights sum to one
    Shares shares;                     // in the next coarser level
    double grip;                       // 1/kg; below 0: it is held
  };

  template <typename Value>
  std::vector<Value> means(const std::vector<Value>& of_particles) const;

  std::vector<Node> nodes_;            // coarsest level first
  std::size_t finest_ = 0;             // the first of the finest level
  std::vector<Shares> shares_;         // of each particle
  Eigen::VectorXd inverse_masses_;     // 1/kg
};

}  // namespace weft::reference
