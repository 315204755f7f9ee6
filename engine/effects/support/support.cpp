#include "engine/effects/support/support.h"

#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::supports, &buffers::level_supports};

// Jacobi is for cloth that gives way, and what is held has a momentum that no collider is told. Further iterations would rub again by what
// the first has held.
bool is_called_for(const Scene& scene, const CookedFabric& fabric) {
  const Method method = method_of(scene);
  const bool has_formulas = scene.colliders.size() > fabric.collider_meshes.size();
  return has_formulas && (method == Method::strands || method == Method::gauss_seidel) && scene.solver.iterations == 1 && !scene.reactions;
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
