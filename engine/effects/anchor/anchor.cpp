#include "engine/effects/anchor/anchor.h"

#include "engine/effects/effect.h"

namespace weft {

std::vector<gpu::Anchor> anchors_at_rest(const CookedFabric& fabric, std::uint32_t pins) {
  std::vector<gpu::Anchor> anchors;
  for (const AnchorTarget& anchor : fabric.anchors) {
    const gpu::vec3 rest{anchor.rest.x, anchor.rest.y, anchor.rest.z};
    anchors.push_back({anchor.particle, rest, rest});
  }
  anchors.resize(anchors.size() + pins, {WEFT_NONE, {}, {}});
  for (const ColliderMesh& mesh : fabric.collider_meshes)
    for (std::uint32_t i = mesh.first_particle; i < mesh.first_particle + mesh.particles; ++i) {
      const gpu::vec4& x = fabric.positions[i];
      anchors.push_back({i, {x.x, x.y, x.z}, {x.x, x.y, x.z}});
    }
  return anchors;
}

namespace effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::anchors};

constexpr Pass kPasses[] = {
    {.name = "anchor",
     .stage = Stage::substep_begin,
     .threads = {lengths::anchors},
     .with_contacts = "+watch",
     .only_towards_targets = true},
};

constexpr Figure kFigures[] = {{.name = "anchored", .cooked = [](const CookedFabric& f) { return std::uint64_t(f.anchors.size()); }}};

}  // namespace

constinit const Effect anchor{
    .name = "anchor",
    .called_for = [](const Scene& scene, const CookedFabric& fabric) { return kinematic_particles(fabric) + scene.pins > 0; },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize = [](const Cooked& s, Constants& constants) { constants[gpu::constant::has_pins] = s.scene.pins > 0; },
    .reference = Reference::modelled,
    .figures = kFigures,
};

}  // namespace effects
}  // namespace weft
