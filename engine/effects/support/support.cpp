#include "engine/effects/support/support.h"

#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::supports, &buffers::level_supports};

}  // namespace

constinit const Effect support{
    .name = "support",
    .key = "colliders",
    .called_for =
        [](const Scene& scene, const CookedFabric& fabric) {
          const Method method = method_of(scene);
          const bool is_aware = method == Method::jacobi || method == Method::strands || method == Method::gauss_seidel;
          return is_aware && scene.solver.iterations == 1 && !scene.reactions && scene.colliders.size() > fabric.collider_meshes.size();
        },
    .buffers = kBuffers,
    .specialize = [](const Cooked&, Constants& constants) { constants[gpu::constant::has_supports] = 1; },
    .reference = Reference::a_way_to,
};

}  // namespace weft::effects
