// Splits points of a mesh: what is torn or cut is a mesh again, of the same triangles, one of whose points has become two.
#include <algorithm>
#include <map>

#include "engine/mesh.h"

namespace weft {
namespace {

using Corners = std::vector<std::vector<std::uint32_t>>;   // of triangles, by point, growing

Corners corners_of(const Mesh& mesh) {
  Corners corners(mesh.points.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) corners[mesh.triangles[t][k]].push_back(3 * t + k);
  return corners;
}

Result<void> check_split(const Mesh& mesh, const Corners& corners, const Split& split) {
  if (split.point >= mesh.points.size()) return fail("a split: ", split.point, " is not one of the ", mesh.points.size(), " points");
  const std::size_t around = corners[split.point].size();
  if (split.corners.empty() || split.corners.size() >= around)
    return fail("a split of point ", split.point, ": ", split.corners.size(), " of its ", around, " corners are none or all of them");
  for (std::size_t k = 0; k < split.corners.size(); ++k) {
    const std::uint32_t corner = split.corners[k];
    if (corner / 3 >= mesh.triangles.size()) return fail("a split: corner ", corner, " is of none of the ", mesh.triangles.size(), " triangles");
    if (mesh.triangles[corner / 3][corner % 3] != split.point) return fail("a split: corner ", corner, " is not of point ", split.point);
    if (k > 0 && corner <= split.corners[k - 1]) return fail("a split: corner ", corner, " is not above the one before");
  }
  return {};
}

template <class T>
void append_copy(std::vector<T>& list, std::uint32_t at) {
  if (at < list.size()) list.push_back(T(list[at]));
}

// The new point's entry in every list of points.
void append_point(Mesh& mesh, std::uint32_t point) {
  const auto added = static_cast<std::uint32_t>(mesh.points.size());
  append_copy(mesh.points, point);
  for (auto& [name, values] : mesh.attributes) append_copy(values, point);
  if (!mesh.skin) return;
  append_copy(mesh.skin->joints_of, point);
  append_copy(mesh.skin->weights, point);
  for (Skin::Morph& morph : mesh.skin->morphs) {
    const auto at = std::ranges::lower_bound(morph.points, point);
    if (at == morph.points.end() || *at != point) continue;
    const auto k = static_cast<std::uint32_t>(at - morph.points.begin());
    append_copy(morph.deltas, k);
    append_copy(morph.normal_deltas, k);
    morph.points.push_back(added);
  }
}

// False where there is no room left.
Result<bool> split_point(Mesh& mesh, Corners& corners, const Split& split) {
  if (auto good = check_split(mesh, corners, split); !good) return good.take_error();
  RenderMesh& render = mesh.render;
  // Vertices of the corners that go, and whether one that stays has them, too.
  std::map<std::uint32_t, std::uint32_t> becomes;
  for (const std::uint32_t corner : split.corners) becomes[render.triangles[corner / 3][corner % 3]] = kNone;
  const auto goes = [&](std::uint32_t corner) { return std::ranges::binary_search(split.corners, corner); };
  std::uint32_t doubled = 0;
  const auto next = static_cast<std::uint32_t>(render.positions.size()) - mesh.spare_vertices;
  for (const std::uint32_t corner : corners[split.point]) {
    if (goes(corner)) continue;
    const auto at = becomes.find(render.triangles[corner / 3][corner % 3]);
    if (at != becomes.end() && at->second == kNone) at->second = next + doubled++;
  }
  // A point without a vertex would be none: the one that stays keeps its own.
  if (mesh.spare_points == 0 || doubled > mesh.spare_vertices) return false;

  const auto added = static_cast<std::uint32_t>(mesh.points.size());
  append_point(mesh, split.point);
  for (const auto& [vertex, copy] : becomes) {
    mesh.point_of[copy == kNone ? vertex : copy] = added;
    if (copy == kNone) continue;
    render.positions[copy] = render.positions[vertex];
    render.normals[copy] = render.normals[vertex];
    render.tangents[copy] = render.tangents[vertex];
    render.uvs[copy] = render.uvs[vertex];
  }
  for (const std::uint32_t corner : split.corners) {
    std::uint32_t& vertex = render.triangles[corner / 3][corner % 3];
    if (const std::uint32_t copy = becomes.at(vertex); copy != kNone) vertex = copy;
    mesh.triangles[corner / 3][corner % 3] = added;
  }
  std::erase_if(corners[split.point], goes);
  corners.push_back(split.corners);
  mesh.spare_vertices -= doubled;
  --mesh.spare_points;
  return true;
}

}  // namespace

void add_spares(Mesh& mesh, std::uint32_t count) {
  RenderMesh& render = mesh.render;
  const std::uint32_t first = static_cast<std::uint32_t>(std::ranges::find(mesh.point_of, 0u) - mesh.point_of.begin());
  for (std::uint32_t k = 0; k < count; ++k) {
    append_copy(render.positions, first);
    append_copy(render.normals, first);
    append_copy(render.tangents, first);
    append_copy(render.uvs, first);
    mesh.point_of.push_back(0);
  }
  mesh.spare_vertices += count;
  mesh.spare_points += count;
}

Result<std::size_t> split_points(Mesh& mesh, std::span<const Split> splits) try {
  Corners corners = corners_of(mesh);
  std::size_t done = 0;
  for (const Split& split : splits) {
    const auto was_split = split_point(mesh, corners, split);
    if (!was_split) return was_split.why();
    if (!*was_split) break;
    ++done;
  }
  mesh.edges = winged_edges(mesh.triangles, nullptr);
  return done;
} catch (...) {
  return caught("the splits");
}

}  // namespace weft
