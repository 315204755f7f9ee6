// The threads of a mesh whose edges follow them. Internal.
#pragma once

#include <vector>

#include "engine/mesh/geodesics.h"

namespace weft::cooking {

/// About how many edges lie between a crossing and the next along a thread, where cells are square.
constexpr std::uint32_t kThreadsApart = 3;

/// Of each point of a mesh.
struct Crossings {
  std::vector<bool> is_woven;   // it belongs to a piece whose edges follow threads, or lies between these
  std::vector<bool> is_on;      // and lies where some threads of the warp cross some of the weft, the outermost among them
};

inline Crossings no_crossings(std::size_t points) { return {std::vector<bool>(points), std::vector<bool>(points)}; }

/// `points`: how many there are, with those of no triangle.
Crossings crossings_of(const IntrinsicSurface& surface, std::size_t points);

}  // namespace weft::cooking
