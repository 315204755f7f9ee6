// Mesh colliders: surfaces that collide with cloth through the passes of self-collision. Their vertices are kinematic
// particles, which only the scene moves.
#include <bit>

#include "engine/cook/parts.h"

namespace weft {
namespace cooking {
namespace {

// A render vertex gets the corners around it that have its normal: a hard edge of the file stays hard in the picture, while a
// seam of texture coordinates is not seen.
void add_surface(const Mesh& mesh, std::span<const std::uint32_t> particle_of, CookedFabric& fabric) {
  struct Corner {
    std::uint32_t vertex;
    gpu::uvec2 others;
  };
  constexpr float kSame = 1 - 1e-4f;   // of the normals' cosine: less than a degree
  std::vector<std::vector<Corner>> corners(mesh.points.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto& points = mesh.triangles[t];
      corners[points[k]].push_back({mesh.render.triangles[t][k], {particle_of[points[(k + 1) % 3]], particle_of[points[(k + 2) % 3]]}});
    }
  for (std::uint32_t v = 0; v < mesh.point_of.size(); ++v) {
    const auto first = static_cast<std::uint32_t>(fabric.corners.size());
    for (const Corner& corner : corners[mesh.point_of[v]])
      if (dot(mesh.render.normals[corner.vertex], mesh.render.normals[v]) > kSame) fabric.corners.push_back(corner.others);
    fabric.surface_rows.push_back({particle_of[mesh.point_of[v]], first, static_cast<std::uint32_t>(fabric.corners.size()) - first, 0});
  }
}

}  // namespace

Result<void> add_collider_mesh(const Scene& scene, std::uint32_t collider, const Mesh& mesh, CookedFabric& fabric) {
  const Collider& described = scene.colliders[collider];
  const auto first = static_cast<std::uint32_t>(fabric.positions.size());
  const auto count = static_cast<std::uint32_t>(mesh.points.size());
  if (first + mesh.points.size() > WEFT_MAX_PARTICLES)
    return fail("colliders[", collider, "]: the scene's ", first + mesh.points.size(), " particles are more than ", WEFT_MAX_PARTICLES);
  const auto thickness = static_cast<float>(described.thickness);
  const std::vector<std::uint32_t> order = locality_order(mesh);
  std::vector<std::uint32_t> particle_of(mesh.points.size());
  for (std::uint32_t k = 0; k < count; ++k) {
    particle_of[order[k]] = first + k;
    const Vec3 x = mesh.points[order[k]];
    fabric.rest.push_back({x.x, x.y, x.z, thickness});
  }
  const ColliderMesh& added = fabric.collider_meshes.emplace_back(ColliderMesh{
      collider, first, count, static_cast<std::uint32_t>(fabric.surface_rows.size()), static_cast<std::uint32_t>(mesh.point_of.size()),
      static_cast<std::uint32_t>(fabric.triangles.size()), static_cast<std::uint32_t>(mesh.triangles.size())});

  const auto material = std::bit_cast<float>(static_cast<std::uint32_t>(fabric.materials.size()));
  fabric.materials.push_back({1, static_cast<float>(described.friction), thickness,
                              static_cast<float>(fabric.cloths.size() + fabric.collider_meshes.size() - 1)});
  const Key key = pose_at(described.keys, 0);
  const Rotation rotation = rotation_about(key.axis, key.degrees) * rest_rotation(described);
  for (std::uint32_t k = 0; k < added.particles; ++k) {
    const Vec3 x = collider_point(fabric, added, k, described.centre + key.translate, rotation);
    fabric.positions.push_back({x.x, x.y, x.z, 0});
    fabric.velocities.push_back({0, 0, 0, material});
  }
  for (const auto& [a, b, c] : mesh.triangles) fabric.triangles.push_back({particle_of[a], particle_of[b], particle_of[c]});
  add_surface(mesh, particle_of, fabric);
  return {};
}

}  // namespace cooking

Vec3 collider_point(const CookedFabric& fabric, const ColliderMesh& mesh, std::uint32_t k, Vec3 centre, const Rotation& rotation) {
  const gpu::vec4& rest = fabric.rest[mesh.first_particle + k];
  return centre + rotated(rotation, {rest.x, rest.y, rest.z});
}

std::vector<Vec3> collider_points(const CookedFabric& fabric, const ColliderMesh& mesh, Vec3 centre, const Rotation& rotation) {
  std::vector<Vec3> points(mesh.particles);
  for (std::uint32_t k = 0; k < mesh.particles; ++k) points[k] = collider_point(fabric, mesh, k, centre, rotation);
  return points;
}

std::uint32_t kinematic_particles(const CookedFabric& fabric) {
  auto count = static_cast<std::uint32_t>(fabric.anchors.size());
  for (const ColliderMesh& mesh : fabric.collider_meshes) count += mesh.particles;
  return count;
}

std::uint32_t cloth_particles(const CookedFabric& fabric) {
  return fabric.cloths.back().first_particle + fabric.cloths.back().particles;
}

std::uint32_t cloth_vertices(const CookedFabric& fabric) {
  return fabric.cloths.back().first_vertex + fabric.cloths.back().vertices;
}

}  // namespace weft
