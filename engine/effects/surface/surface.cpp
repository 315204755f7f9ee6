#include "engine/effects/surface/surface.h"

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::triangles, &buffers::surface_rows, &buffers::corners, &buffers::vertex_positions,
                                      &buffers::vertex_normals};

constexpr Pass kPasses[] = {{.name = "surface", .stage = Stage::frame_end, .threads = threads::vertices}};

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  CookedFabric& fabric = state.fabric();
  const Mesh& mesh = input.mesh;
  const auto particle_of = state.particle_of();
  std::vector<std::vector<gpu::uvec2>> corners(mesh.points.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    corners[a].push_back({particle_of[b], particle_of[c]});
    corners[b].push_back({particle_of[c], particle_of[a]});
    corners[c].push_back({particle_of[a], particle_of[b]});
    fabric.triangles.push_back({particle_of[a], particle_of[b], particle_of[c]});
  }
  std::vector<std::uint32_t> first;
  for (const auto& list : corners) {
    first.push_back(static_cast<std::uint32_t>(fabric.corners.size()));
    fabric.corners.insert(fabric.corners.end(), list.begin(), list.end());
  }
  for (const std::uint32_t p : mesh.point_of)
    fabric.surface_rows.push_back({particle_of[p], first[p], static_cast<std::uint32_t>(corners[p].size()), 0});
  fabric.cloth_triangles = static_cast<std::uint32_t>(fabric.triangles.size());
  return {};
}

}  // namespace

constinit const Effect surface{
    .name = "surface",
    .called_for = [](const Scene&, const CookedFabric&) { return true; },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::modelled,
    .cook = cook,
};

}  // namespace weft::effects
