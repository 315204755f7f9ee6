// From a surface to the next coarser one. Internal.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mesh/geodesics.h"

namespace weft::cooking {

/// Three nodes, by their numbers, and the parts of a point's displacement that are theirs, which sum to one: below 0 where the point lies a
/// little outside of them; unused places have a part of 0.
struct Share {
  std::array<std::uint32_t, 3> node{};
  std::array<double, 3> part{};
  std::array<double, 3> place{};   // where the point is, by its nodes: its parts, unless it lies far outside
};

struct CoarseLink {
  std::uint32_t a, b;      // nodes
  double rest;             // m, along the surface
  double along;            // Waves::Arrived
};

struct Coarse {
  std::vector<std::uint32_t> points;   // of the finer surface: those that are nodes
  std::vector<Share> shares;           // of each point of the finer surface
  std::vector<CoarseLink> links;
  IntrinsicSurface surface;                     // over the nodes
};

/// What a point is to the choice of nodes: those of a higher rank have nodes among them, as near to each other as all nodes are, before
/// others are chosen. So what is held is held at every level, and no level ends before the cloth does.
enum class Rank : std::uint8_t { inner, rim, corner, held };

/// Of each point of a mesh; nothing is held yet.
std::vector<Rank> ranks_of(const Mesh& mesh);

/// Where nodes lie: farthest point first, or along threads where the mesh's edges follow these (threads.h).
enum class Nodes { anywhere, along_threads };

/// Nodes three to four edges apart. `uvs` are those of the points; empty or not finite where there is none.
Coarse coarsen(const IntrinsicSurface& fine, std::span<const Rank> ranks, std::span<const Vec2> uvs, Nodes where = Nodes::anywhere);

}  // namespace weft::cooking
