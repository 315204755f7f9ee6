#include "engine/effects/support/support.h"

#include <algorithm>

#include "engine/effects/collide/collide.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::supports, &buffers::level_supports};

// Jacobi is for cloth that gives way, and what is held has a momentum that no collider is told. Further iterations would rub again by what
// the first has held. A collider that grows pushes cloth ahead of itself; held, that cloth left it a seventh faster.
bool is_called_for(const Scene& scene, const CookedFabric& fabric) {
  const Method method = method_of(scene);
  const bool has_formulas = scene.colliders.size() > fabric.collider_meshes.size();
  const bool is_aware = method == Method::strands || method == Method::gauss_seidel;
  return has_formulas && is_aware && scene.solver.iterations == 1 && !scene.reactions &&
         std::ranges::none_of(scene.colliders, may_resize);
}

}  // namespace

constinit const Effect support{
    .name = "support",
    .key = "colliders",
    .called_for = is_called_for,
    .buffers = kBuffers,
    .specialize = [](const Cooked&, Constants& constants) { constants[gpu::constant::has_supports] = 1; },
    .reference = Reference::a_way_to,
};

}  // namespace weft::effects
