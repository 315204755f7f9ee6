#include "engine/effects/support/support.h"

#include "engine/cook/cook_state.h"
#include "engine/effects/collide/collide.h"
#include "engine/effects/collide/weave.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::supports, &buffers::support_bodies, &buffers::level_supports};

// Of the cloth's width, the root of its area. The end of a body with a smaller radius carries more than twenty times what lies on it.
constexpr double kThin = 0.125;

// Triangles. So few a solve manages without: a sheet of 48 x 48 cells stretches little more at a thin end, and at rest over a box moves less.
constexpr std::uint32_t kFew = 5000;

bool carries_by_little(const Collider& collider, const Weave& weave) {
  return weave.triangles > kFew && (collider.shape == ColliderShape::box || may_resize(collider) || is_thin(collider, weave, kThin));
}

void lay_out(cooking::CookState& state) {
  const Scene& scene = state.scene();
  if (scene.colliders.empty() || state.fabric().cloth_triangles <= kFew) return;
  const std::vector<Weave> weaves = weaves_of(state.fabric());
  bool& holds = state.fabric().own.of<SupportLists>().holds;
  for (const Collider& collider : scene.colliders)
    for (std::size_t k = 0; k < weaves.size(); ++k)
      holds = holds || (meet(scene.cloths[k], collider) && carries_by_little(collider, weaves[k]));
}

bool is_called_for(const Scene& scene, const CookedFabric& fabric) {
  const Method method = method_of(scene);
  return fabric.own.of<SupportLists>().holds &&
         (method == Method::jacobi || method == Method::strands || method == Method::gauss_seidel);
}

}  // namespace

constinit const Effect support{
    .name = "support",
    .key = "colliders",
    .called_for = is_called_for,
    .buffers = kBuffers,
    .specialize = [](const Cooked&, Constants& constants) { constants[gpu::constant::has_supports] = 1; },
    .reference = Reference::a_way_to,
    .lay_out = lay_out,
};

}  // namespace weft::effects
