// Colliders given by a signed distance: planes, spheres, capsules and boxes. Mesh colliders belong to the effect contact.
#pragma once

#include "engine/collider_pose.h"
#include "engine/effects/buffer.h"

namespace weft {

/// Which colliders a cloth meets, where it is not all: rows of bits (collide/mask.glsl).
struct BodyMasks {
  std::vector<gpu::uint> words;
};

/// A capsule whose ends have two radii, or may get them.
bool is_tapered(const Collider& collider);
/// Whether it has a size that the host may change.
bool may_resize(const Collider& collider);

/// As shaders have it (collide/round_cone.glsl).
gpu::BodySize body_size(ColliderShape shape, const ColliderSize& size);

/// Indices of the colliders that are formulas, by shape: the order of `colliders`.
std::vector<std::uint32_t> colliders_by_shape(const Scene& scene);

namespace lengths {
inline std::uint64_t formulas(const Cooked& s) { return s.scene.colliders.size() - s.fabric.collider_meshes.size(); }
}  // namespace lengths

namespace buffers {

/// Poses at the frame's start and end: all planes, then all spheres, capsules and boxes. With reactions then all meshes, with the places of
/// their centres alone.
inline constexpr Buffer colliders = buffer<gpu::Collider>("colliders", Lifetime::uploaded, [](const Cooked& s) {
  return lengths::formulas(s) + (s.scene.reactions ? s.fabric.collider_meshes.size() : 0);
});
/// Their sizes at the frame's start, where the host may resize some.
inline constexpr Buffer body_sizes = buffer<gpu::BodySize>("body_sizes", Lifetime::uploaded, lengths::formulas);
inline constexpr Buffer body_masks = own<gpu::uint, &BodyMasks::words>("body_masks");

}  // namespace buffers
}  // namespace weft
