#include "engine/effects/collide/collide.h"

#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::colliders};

void specialize(const Cooked& s, Constants& constants) {
  constants[gpu::constant::has_colliders] = 1;
  for (const Collider& collider : s.scene.colliders) switch (collider.shape) {
      case ColliderShape::plane: ++constants[gpu::constant::planes]; break;
      case ColliderShape::sphere: ++constants[gpu::constant::spheres]; break;
      case ColliderShape::capsule: ++constants[gpu::constant::capsules]; break;
      case ColliderShape::box: ++constants[gpu::constant::boxes]; break;
      case ColliderShape::mesh: break;
    }
}

}  // namespace

constinit const Effect collide{
    .name = "collide",
    .key = "colliders",
    .called_for = [](const Scene& scene, const CookedFabric& fabric) { return scene.colliders.size() > fabric.collider_meshes.size(); },
    .buffers = kBuffers,
    .part_of_finalize = "+collide",
    .specialize = specialize,
    .reference = Reference::absent,
};

}  // namespace weft::effects
