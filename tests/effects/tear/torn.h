// Sheets that tear, and what torn meshes are told apart by.
#pragma once

#include <algorithm>
#include <numeric>
#include <set>

#include "engine/effects/tear/tear.h"
#include "tests/support/must.h"

namespace weft {

/// A sheet in the xy plane, 1 m wide, with room to be split.
inline Mesh tearable(std::uint32_t cells, std::uint32_t spare, Topology topology = Topology::diagonal) {
  Mesh mesh = make_grid(Grid{{1, 1}, cells, cells, topology, true});
  add_spares(mesh, spare);
  return mesh;
}

inline std::vector<Eigen::Vector3d> places_of(const Mesh& mesh) {
  std::vector<Eigen::Vector3d> places;
  for (const Vec3 p : mesh.points) places.emplace_back(p.x, p.y, p.z);
  return places;
}

inline bool nobody(std::uint32_t) { return false; }

/// Of each point, one of the points that hang together with it by triangles: the same for all of them.
inline std::vector<std::uint32_t> pieces_of(const Mesh& mesh) {
  std::vector<std::uint32_t> of(mesh.points.size());
  std::iota(of.begin(), of.end(), 0u);
  const auto root = [&](std::uint32_t p) {
    while (of[p] != p) p = of[p] = of[of[p]];
    return p;
  };
  for (const auto& [a, b, c] : mesh.triangles) of[root(a)] = root(b), of[root(b)] = root(c);
  std::vector<std::uint32_t> roots;
  for (std::uint32_t p = 0; p < of.size(); ++p) roots.push_back(root(p));
  return roots;
}

inline std::size_t pieces(const Mesh& mesh) {
  const auto of = pieces_of(mesh);
  return std::set<std::uint32_t>(of.begin(), of.end()).size();
}

inline double area_of(const Mesh& mesh) {
  const auto at = places_of(mesh);
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) area += 0.5 * (at[b] - at[a]).cross(at[c] - at[a]).norm();
  return area;
}

}  // namespace weft
