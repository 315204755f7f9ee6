// From a surface to the next coarser one. Internal.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mesh/geodesics.h"

namespace weft::cooking {

/// Three nodes, by their numbers, and the parts of a point's displacement that are theirs, which sum to one; unused places have a part of 0.
struct Share {
  std::array<std::uint32_t, 3> node{};
  std::array<double, 3> part{};
};

struct CoarseLink {
  std::uint32_t a, b;      // nodes
  double rest;             // m, along the surface
  double askew;            // Waves::Arrived
};

struct Coarse {
  std::vector<std::uint32_t> points;   // of the finer surface: those that are nodes
  std::vector<Share> shares;           // of each point of the finer surface
  std::vector<CoarseLink> links;
  IntrinsicSurface surface;                     // over the nodes
};

/// Nodes about four edges apart. Points that are `held` have nodes among them as near to each other as all nodes are, so that what is held
/// in one place is held there at every level. `uvs` are those of the points; empty or not finite where there is none.
Coarse coarsen(const IntrinsicSurface& fine, const std::vector<bool>& held, std::span<const Vec2> uvs);

}  // namespace weft::cooking
