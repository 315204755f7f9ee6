// See engine/c/weft.h: the parts of what is drawn.
#include "engine/c/inside.h"

#include <algorithm>

using weft::fail;
using weft::Result;
using namespace weft::c;

namespace {

// The mesh of a part, or none. Simulation::meshes has one a part, in this order.
const weft::Mesh* mesh_of(const weft_simulation* simulation, std::uint32_t part) {
  return part < weft_part_count(simulation) ? &simulation->simulation->meshes()[part] : nullptr;
}

// Whether the scene asks for the skin of what has this part.
bool goes_with_skin(const weft::Scene& scene, const weft_part& part) {
  if (part.kind == WEFT_CLOTH) return scene.cloths[part.of].skin.has_value();
  return part.kind == WEFT_MESH_COLLIDER && scene.colliders[part.of].skin.has_value();
}

}  // namespace

uint32_t weft_part_count(const weft_simulation* simulation) {
  return simulation != nullptr ? static_cast<std::uint32_t>(simulation->simulation->meshes().size()) : 0;
}

weft_status weft_get_part(const weft_simulation* simulation, uint32_t part, weft_part* about, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(about);
    const weft::Mesh* mesh = mesh_of(simulation, part);
    if (mesh == nullptr) return fail("there is no part ", part, ", but ", weft_part_count(simulation));
    const weft::CookedFabric& fabric = simulation->simulation->fabric();
    const auto cloths = static_cast<std::uint32_t>(fabric.cloths.size());
    const auto bodies = static_cast<std::uint32_t>(fabric.collider_meshes.size());
    weft_part told{};
    told.kind = part < cloths ? WEFT_CLOTH : part - cloths < bodies ? WEFT_MESH_COLLIDER : WEFT_RENDER_MESH;
    told.of = part < cloths            ? part
              : part - cloths < bodies ? fabric.collider_meshes[part - cloths].collider
                                       : fabric.render_meshes[part - cloths - bodies].cloth;
    for (std::uint32_t k = 0; k < part; ++k) {
      const weft::RenderMesh& before = simulation->simulation->meshes()[k].render;
      told.first_vertex += static_cast<std::uint32_t>(before.positions.size());
      told.first_triangle += static_cast<std::uint32_t>(before.triangles.size());
    }
    told.vertices = static_cast<std::uint32_t>(mesh->render.positions.size());
    told.triangles = static_cast<std::uint32_t>(mesh->render.triangles.size());
    if (goes_with_skin(simulation->simulation->scene(), told)) {
      told.joints = mesh->skin ? std::max(1u, static_cast<std::uint32_t>(mesh->skin->joints.size())) : 1;
      told.morphs = mesh->skin ? static_cast<std::uint32_t>(mesh->skin->morphs.size()) : 0;
    }
    *about = told;
    return {};
  });
}

const char* weft_joint_name(const weft_simulation* simulation, uint32_t part, uint32_t joint) {
  const weft::Mesh* mesh = mesh_of(simulation, part);
  return mesh != nullptr && mesh->skin && joint < mesh->skin->joints.size() ? mesh->skin->joints[joint].name.c_str() : "";
}

const char* weft_morph_name(const weft_simulation* simulation, uint32_t part, uint32_t morph) {
  const weft::Mesh* mesh = mesh_of(simulation, part);
  return mesh != nullptr && mesh->skin && morph < mesh->skin->morphs.size() ? mesh->skin->morphs[morph].name.c_str() : "";
}
