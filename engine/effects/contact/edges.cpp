// What contacts need of the fabric: every edge once, and rest positions. Cooked only for scenes with contacts.
#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

// Sorted by particles, which are in locality order: neighbours in the list are neighbours in the cloth.
std::vector<gpu::uvec2> edges_of(std::span<const Triangle> triangles) {
  std::vector<gpu::uvec2> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.push_back({a, b});
    }
  const auto key = [](gpu::uvec2 edge) { return std::uint64_t{edge.x} << 32 | edge.y; };
  std::sort(edges.begin(), edges.end(), [&](gpu::uvec2 a, gpu::uvec2 b) { return key(a) < key(b); });
  edges.erase(std::unique(edges.begin(), edges.end(), [&](gpu::uvec2 a, gpu::uvec2 b) { return key(a) == key(b); }), edges.end());
  return edges;
}

}  // namespace

void add_rest(CookedFabric& fabric) {
  for (std::size_t i = 0; i < fabric.positions.size(); ++i) {
    const gpu::vec4& x = fabric.positions[i];
    const auto material = std::bit_cast<std::uint32_t>(fabric.velocities[i].w);
    fabric.rest.push_back({x.x, x.y, x.z, fabric.materials[material].thickness});
  }
}

void add_edges(CookedFabric& fabric) {
  fabric.edges = edges_of(fabric.triangles);
  const std::uint32_t cloth = cloth_particles(fabric);
  double length = 0;
  std::size_t count = 0;
  for (const gpu::uvec2 edge : fabric.edges) {
    if (edge.x >= cloth) break;   // sorted, and colliders come last
    const gpu::vec4 &a = fabric.rest[edge.x], &b = fabric.rest[edge.y];
    length += std::hypot(double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z);
    ++count;
  }
  fabric.mean_edge = count == 0 ? 0 : length / static_cast<double>(count);
}

}  // namespace weft::cooking
