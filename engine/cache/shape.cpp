// Which vertices of a simulation a cache has, and in which order.
#include <algorithm>
#include <cassert>
#include <map>

#include "engine/cache.h"
#include "engine/mesh/materials.h"

namespace weft {
namespace {

// The mesh that is drawn for a cloth, and where its render vertices begin among the simulation's.
struct Shown {
  const Mesh& mesh;
  std::uint32_t first_vertex;
};

Shown shown_of(const CookedFabric& fabric, std::span<const Mesh> meshes, std::size_t cloth) {
  for (std::size_t k = 0; k < fabric.render_meshes.size(); ++k)
    if (fabric.render_meshes[k].cloth == cloth)
      return {meshes[fabric.cloths.size() + fabric.collider_meshes.size() + k], fabric.render_meshes[k].first_vertex};
  return {meshes[cloth], fabric.cloths[cloth].first_vertex};
}

// Render vertices lie in the file's order, so a vertex of the file is the next one of its point, or, where copies were joined, any of it.
void add_source(CachedShape& shape, const Shown& shown, Vec3 origin) {
  const Mesh& mesh = shown.mesh;
  std::vector<std::uint32_t> first_of(mesh.points.size(), kNone);
  for (std::uint32_t v = 0; v < mesh.point_of.size(); ++v)
    if (std::uint32_t& first = first_of[mesh.point_of[v]]; first == kNone) first = v;
  std::uint32_t next = 0;
  std::size_t loose = 0;
  const auto add = [&](Vec3 rest, std::uint32_t vertex) {
    shape.mesh.positions.push_back(rest + origin);
    shape.vertices.push_back(vertex);
  };
  for (const std::uint32_t point : mesh.point_of_source) {
    if (point == kNone) {
      add(mesh.loose[loose++], kNone);
      continue;
    }
    const std::uint32_t vertex = next < mesh.point_of.size() && mesh.point_of[next] == point ? next++ : first_of[point];
    add(mesh.render.positions[vertex], shown.first_vertex + vertex);
  }
}

// The materials of all cloths; those of one file once.
struct Joined {
  std::shared_ptr<Materials> all;
  std::map<const Materials*, std::uint32_t> first;
};

void add_render(CachedShape& shape, Joined& joined, const Shown& shown, Vec3 origin) {
  const RenderMesh& render = shown.mesh.render;
  const auto first = static_cast<std::uint32_t>(shape.mesh.positions.size());
  for (std::uint32_t v = 0; v < render.positions.size(); ++v) {
    shape.mesh.positions.push_back(render.positions[v] + origin);
    shape.vertices.push_back(shown.first_vertex + v);
  }
  shape.mesh.normals.insert(shape.mesh.normals.end(), render.normals.begin(), render.normals.end());
  shape.mesh.uvs.insert(shape.mesh.uvs.end(), render.uvs.begin(), render.uvs.end());
  for (const Triangle& t : render.triangles) shape.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  if (render.material_of.empty()) return;
  if (!joined.all) joined.all = std::make_shared<Materials>();
  const auto [known, is_new] = joined.first.try_emplace(render.materials.get());
  if (is_new) known->second = parts::append(*joined.all, *render.materials);
  shape.mesh.material_of.resize(shape.mesh.triangles.size() - render.triangles.size(), kNone);
  for (const std::uint32_t m : render.material_of) shape.mesh.material_of.push_back(m == kNone ? kNone : known->second + m);
}

std::vector<Vec3> chosen(const CachedShape& shape, std::span<const Vec3> all, std::span<const Vec3> at_rest) {
  std::vector<Vec3> list(shape.vertices.size());
  for (std::size_t v = 0; v < list.size(); ++v) {
    if (shape.vertices[v] < all.size()) list[v] = all[shape.vertices[v]];
    else if (v < at_rest.size()) list[v] = at_rest[v];
  }
  return list;
}

}  // namespace

Result<void> check_cached(const Scene& scene) {
  for (std::size_t c = 0; c < scene.cloths.size(); ++c)
    if (scene.cloths[c].tear)
      return fail("cloths[", c, "].tear: a cache has the same triangles in all of its frames, and this cloth tears");
  return {};
}

CachedShape cached_shape(const CookedFabric& fabric, std::span<const Mesh> meshes, Vec3 origin, CacheFormat format) {
  assert(meshes.size() == fabric.cloths.size() + fabric.collider_meshes.size() + fabric.render_meshes.size());
  CachedShape shape;
  Joined joined;
  for (std::size_t cloth = 0; cloth < fabric.cloths.size(); ++cloth) {
    const Shown shown = shown_of(fabric, meshes, cloth);
    if (is_point_cache(format) && !shown.mesh.point_of_source.empty()) add_source(shape, shown, origin);
    else add_render(shape, joined, shown, origin);
  }
  shape.mesh.materials = std::move(joined.all);
  if (shape.mesh.materials) shape.mesh.material_of.resize(shape.mesh.triangles.size(), kNone);
  shape.has_strain = fabric.render_meshes.empty() && format == CacheFormat::ply;
  if (!is_point_cache(format)) return shape;
  shape.mesh.normals.clear();
  shape.mesh.uvs.clear();
  shape.mesh.triangles.clear();
  shape.mesh.material_of.clear();
  shape.mesh.materials = nullptr;
  return shape;
}

std::vector<Vec3> cached_positions(const CachedShape& shape, std::span<const Vec3> vertex_positions) {
  return chosen(shape, vertex_positions, shape.mesh.positions);
}

std::vector<Vec3> cached_normals(const CachedShape& shape, std::span<const Vec3> vertex_normals) {
  return chosen(shape, vertex_normals, shape.mesh.normals);
}

}  // namespace weft
