// Checks a mesh that a program made: everything that is used as an index, and what floats cannot hold.
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/finite.h"
#include "engine/mesh/parts.h"

namespace weft {
namespace {

Result<void> lists_are_as_long(const Mesh& mesh) {
  const RenderMesh& render = mesh.render;
  const std::size_t vertices = render.positions.size();
  if (vertices == 0 || mesh.points.empty()) return fail("it has no vertex");
  if (mesh.triangles.empty()) return fail("it has no triangle");
  const auto as_many = [&](const char* name, std::size_t size, const char* as, std::size_t wanted) -> Result<void> {
    if (size != wanted) return fail(name, " has ", size, " entries, and ", as, " has ", wanted);
    return {};
  };
  for (const auto& [name, size] : {std::pair{"render.normals", render.normals.size()}, {"render.tangents", render.tangents.size()},
                                   {"render.uvs", render.uvs.size()}, {"point_of", mesh.point_of.size()}})
    if (auto good = as_many(name, size, "render.positions", vertices); !good) return good;
  return as_many("render.triangles", render.triangles.size(), "triangles", mesh.triangles.size());
}

Result<void> points_are_there(const Mesh& mesh) {
  const auto far = [](const char* list, std::size_t k, Vec3 p) {
    return fail(list, "[", k, "]: (", p.x, ", ", p.y, ", ", p.z, ") is not finite, or ", kTooLarge, " m away or more");
  };
  for (std::size_t k = 0; k < mesh.points.size(); ++k)
    if (!is_finite(mesh.points[k])) return far("points", k, mesh.points[k]);
  for (std::size_t k = 0; k < mesh.render.positions.size(); ++k)
    if (!is_finite(mesh.render.positions[k])) return far("render.positions", k, mesh.render.positions[k]);
  for (std::size_t k = 0; k < mesh.point_of_source.size(); ++k)
    if (mesh.point_of_source[k] >= mesh.points.size() && mesh.point_of_source[k] != kNone)
      return fail("point_of_source[", k, "]: ", mesh.point_of_source[k], " is not one of the ", mesh.points.size(), " points");
  const auto loose = static_cast<std::size_t>(std::ranges::count(mesh.point_of_source, kNone));
  if (loose != mesh.loose.size())
    return fail("loose has ", mesh.loose.size(), " entries, and ", loose, " of point_of_source are of no point");
  for (std::size_t k = 0; k < mesh.loose.size(); ++k)
    if (!is_finite(mesh.loose[k])) return far("loose", k, mesh.loose[k]);
  std::vector<bool> is_drawn(mesh.points.size());
  for (std::size_t k = 0; k < mesh.point_of.size(); ++k) {
    if (mesh.point_of[k] >= mesh.points.size())
      return fail("point_of[", k, "]: ", mesh.point_of[k], " is not one of the ", mesh.points.size(), " points");
    is_drawn[mesh.point_of[k]] = true;
  }
  for (std::size_t k = 0; k < is_drawn.size(); ++k)
    if (!is_drawn[k]) return fail("points[", k, "]: no render vertex belongs to it");
  return {};
}

Result<void> triangles_are_of_points(const Mesh& mesh) {
  if (mesh.spare_vertices >= mesh.point_of.size())
    return fail("spare_vertices: ", mesh.spare_vertices, " of ", mesh.point_of.size(), " vertices leave none to draw");
  const std::size_t drawn = mesh.point_of.size() - mesh.spare_vertices;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& [a, b, c] = mesh.triangles[k];
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t point = mesh.triangles[k][corner], vertex = mesh.render.triangles[k][corner];
      if (point >= mesh.points.size()) return fail("triangles[", k, "]: ", point, " is not one of the ", mesh.points.size(), " points");
      if (vertex >= drawn) return fail("render.triangles[", k, "]: ", vertex, " is not one of the ", drawn, " vertices");
      if (mesh.point_of[vertex] != point)
        return fail("render.triangles[", k, "]: vertex ", vertex, " belongs to point ", mesh.point_of[vertex], ", and triangles has ",
                    point);
    }
    if (a == b || b == c || c == a) return fail("triangles[", k, "]: has a point twice");
  }
  return {};
}

Result<void> edges_are_of_triangles(const Mesh& mesh) {
  std::pair<std::uint32_t, std::uint32_t> last{0, 0};
  for (std::size_t k = 0; k < mesh.edges.size(); ++k) {
    const WingedEdge& edge = mesh.edges[k];
    const std::pair ends = std::minmax(edge.a, edge.b);
    if (ends.second >= mesh.points.size() || ends.first == ends.second)
      return fail("edges[", k, "]: ", edge.a, " and ", edge.b, " are not two of the ", mesh.points.size(), " points");
    if (k > 0 && !(last < std::pair<std::uint32_t, std::uint32_t>(ends)))
      return fail("edges[", k, "]: is not after the one before, in the order of its smaller and its greater point");
    last = ends;
    for (int side = 0; side < 2; ++side) {
      if ((edge.triangle[side] == kNone) != (edge.across[side] == kNone))
        return fail("edges[", k, "]: has a triangle without the point across");
      if (edge.triangle[side] != kNone && (edge.triangle[side] >= mesh.triangles.size() || edge.across[side] >= mesh.points.size()))
        return fail("edges[", k, "]: triangle ", edge.triangle[side], " or point ", edge.across[side], " is not there");
    }
  }
  return {};
}

Result<void> points_are_described(const Mesh& mesh) {
  for (const auto& [name, values] : mesh.attributes) {
    if (values.size() != mesh.points.size())
      return fail("attributes[\"", name, "\"] has ", values.size(), " entries, and points has ", mesh.points.size());
    for (const Vec4& v : values)
      if (!std::isfinite(v.x + v.y + v.z + v.w)) return fail("attributes[\"", name, "\"] has a value that is not finite");
  }
  if (Result<void> good = parts::check_materials(mesh.render); !good) return good;
  return mesh.skin ? parts::check_skin(*mesh.skin, mesh.points.size()) : Result<void>();
}

}  // namespace

Result<void> parts::check_materials(const RenderMesh& render) {
  const std::size_t count = render.materials ? render.materials->count : 0, triangles = render.triangles.size();
  if (!render.material_of.empty() && render.material_of.size() != triangles)
    return fail("render.material_of has ", render.material_of.size(), " entries, and there are ", triangles, " triangles");
  for (const std::uint32_t material : render.material_of)
    if (material != kNone && material >= count) return fail("render.material_of: ", material, " is not one of the ", count, " materials");
  return {};
}

Result<void> check(const Mesh& mesh) try {
  for (const auto good : {lists_are_as_long, points_are_there, triangles_are_of_points, edges_are_of_triangles, points_are_described})
    if (Result<void> done = good(mesh); !done) return done;
  return {};
} catch (...) {
  return caught("the mesh");
}

}  // namespace weft
