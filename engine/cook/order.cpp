// Reverse Cuthill-McKee order of particles: neighbours in the cloth become neighbours in memory.
//
// This work is based on: Cuthill and McKee 1969, reversed after George 1971. A breadth-first search from a vertex at the rim visits
// neighbours by rising degree; on a grid it runs along anti-diagonals whose neighbours are a row length apart.
#include <algorithm>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

using Neighbours = std::vector<std::vector<std::uint32_t>>;

Neighbours neighbours_of(const Mesh& mesh) {
  Neighbours neighbours(mesh.points.size());
  for (const WingedEdge& edge : mesh.edges) {
    neighbours[edge.a].push_back(edge.b);
    neighbours[edge.b].push_back(edge.a);
  }
  for (auto& list : neighbours)
    std::sort(list.begin(), list.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(neighbours[a].size(), a) < std::pair(neighbours[b].size(), b);
    });
  return neighbours;
}

// Appends the component of `start` to `order`, breadth first.
void walk(const Neighbours& neighbours, std::uint32_t start, std::vector<bool>& seen, std::vector<std::uint32_t>& order) {
  seen[start] = true;
  order.push_back(start);
  for (std::size_t next = order.size() - 1; next < order.size(); ++next)
    for (const std::uint32_t other : neighbours[order[next]])
      if (!seen[other]) {
        seen[other] = true;
        order.push_back(other);
      }
}

}  // namespace

std::vector<std::uint32_t> locality_order(const Mesh& mesh) {
  const Neighbours neighbours = neighbours_of(mesh);
  std::vector<std::uint32_t> order, trial;
  order.reserve(mesh.points.size());
  std::vector<bool> seen(mesh.points.size()), tried(mesh.points.size());
  for (std::uint32_t point = 0; point < mesh.points.size(); ++point) {
    if (seen[point]) continue;
    // The last vertex of a first search lies at the rim.
    trial.clear();
    walk(neighbours, point, tried, trial);
    walk(neighbours, trial.back(), seen, order);
  }
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace weft::cooking
