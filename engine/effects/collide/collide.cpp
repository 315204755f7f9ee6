#include "engine/effects/collide/collide.h"

#include <algorithm>
#include <cmath>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft {

bool is_tapered(const Collider& collider) {
  return collider.shape == ColliderShape::capsule && (collider.resizes || radius_at_end(collider) != collider.radius);
}

bool may_resize(const Collider& collider) {
  return collider.resizes && collider.shape != ColliderShape::plane && collider.shape != ColliderShape::mesh;
}

gpu::BodySize body_size(ColliderShape shape, const ColliderSize& size) {
  constexpr double kSteepest = 1 - 1e-5;   // the smaller sphere sticks out by less than a hundred-thousandth of the length: it is left out
  const auto half_length = static_cast<float>(0.5 * size.length);
  if (shape == ColliderShape::box) return {static_cast<float>(size.radius), {0.5f * size.size.x, 0.5f * size.size.y, 0.5f * size.size.z}};
  if (shape != ColliderShape::capsule || size.radius == size.radius_end) return {static_cast<float>(size.radius), {0, half_length, 0}};
  const double taper = (size.radius - size.radius_end) / size.length;
  if (std::abs(taper) >= kSteepest)
    return {static_cast<float>(std::max(size.radius, size.radius_end)), {taper > 0 ? -half_length : half_length, 0, 0}};
  return {static_cast<float>(0.5 * (size.radius + size.radius_end)), {0, half_length, static_cast<float>(taper)}};
}

std::vector<std::uint32_t> colliders_by_shape(const Scene& scene) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t k = 0; k < scene.colliders.size(); ++k)
    if (scene.colliders[k].shape != ColliderShape::mesh) order.push_back(k);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t k) { return scene.colliders[k].shape; });
  return order;
}

namespace effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::colliders, &buffers::body_sizes, &buffers::body_masks};

void specialize(const Cooked& s, Constants& constants) {
  constants[gpu::constant::has_colliders] = 1;
  for (const Collider& collider : s.scene.colliders) switch (collider.shape) {
      case ColliderShape::plane: ++constants[gpu::constant::planes]; break;
      case ColliderShape::sphere: ++constants[gpu::constant::spheres]; break;
      case ColliderShape::capsule: ++constants[gpu::constant::capsules]; break;
      case ColliderShape::box: ++constants[gpu::constant::boxes]; break;
      case ColliderShape::mesh: break;
    }
  constants[gpu::constant::has_tapered] = std::ranges::any_of(s.scene.colliders, is_tapered);
  constants[gpu::constant::resizes] = std::ranges::any_of(s.scene.colliders, may_resize);
  constants[gpu::constant::has_body_masks] = !s.fabric.own.of<BodyMasks>().words.empty();
}

// Nothing where every cloth meets every collider.
void lay_out(cooking::CookState& state) {
  const Scene& scene = state.scene();
  const std::vector<std::uint32_t> order = colliders_by_shape(scene);
  const std::size_t stride = (order.size() + 31) / 32;
  std::vector<gpu::uint> words(stride * scene.cloths.size());
  bool all = true;
  for (std::size_t cloth = 0; cloth < scene.cloths.size(); ++cloth)
    for (std::size_t k = 0; k < order.size(); ++k) {
      const bool meets = meet(scene.cloths[cloth], scene.colliders[order[k]]);
      all &= meets;
      words[cloth * stride + k / 32] |= gpu::uint{meets} << k % 32;
    }
  if (!all) state.fabric().own.of<BodyMasks>().words = std::move(words);
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
    .lay_out = lay_out,
};

}  // namespace effects
}  // namespace weft
