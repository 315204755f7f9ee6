#include "engine/shading/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace weft::shading {
namespace {

static_assert(static_cast<int>(ColliderShape::plane) == WEFT_SHAPE_PLANE && static_cast<int>(ColliderShape::sphere) == WEFT_SHAPE_SPHERE &&
              static_cast<int>(ColliderShape::capsule) == WEFT_SHAPE_CAPSULE && static_cast<int>(ColliderShape::box) == WEFT_SHAPE_BOX);

struct Box {
  Vec3 low{std::numeric_limits<float>::max(), std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};
  Vec3 high = -1.0f * low;

  void add(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

// Cloth follows its moving anchors.
void add_moved(Box& box, const Box& what, std::span<const Key> keys) {
  for (const Key& key : keys) {
    box.add(what.low + key.translate);
    box.add(what.high + key.translate);
  }
}

// The largest distance of a collider's points from its centre (m).
float reach_of(const Collider& collider) {
  if (collider.shape == ColliderShape::box) return 0.5f * length(collider.size);
  if (collider.shape == ColliderShape::sphere) return static_cast<float>(collider.radius);
  return static_cast<float>(std::max(collider.radius, radius_at_end(collider)) + 0.5 * collider.length);
}

vec4 with_zero(Vec3 v) { return {v.x, v.y, v.z, 0}; }

}  // namespace

Extent extent_of(const Scene& scene, std::span<const std::span<const Vec3>> meshes) {
  Box box;
  const std::size_t cloths = scene.cloths.size(), last_collider = cloths + mesh_colliders(scene).size();
  const auto add = [&](const Box& what) {
    box.add(what.low);
    box.add(what.high);
  };
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (i >= cloths && i < last_collider) continue;
    Box cloth;
    for (Vec3 p : meshes[i]) cloth.add(p);
    add(cloth);
    if (i < cloths)
      for (const Anchor& anchor : scene.cloths[i].anchors) add_moved(box, cloth, anchor.keys);
  }
  std::size_t next_mesh = cloths;
  for (const Collider& collider : scene.colliders) {
    if (collider.shape == ColliderShape::plane) continue;
    float r = 0;
    if (collider.shape != ColliderShape::mesh) r = reach_of(collider);
    else if (next_mesh < meshes.size())
      for (Vec3 p : meshes[next_mesh++]) r = std::max(r, length(p));
    const Box around{collider.centre - Vec3{r, r, r}, collider.centre + Vec3{r, r, r}};
    add(around);
    add_moved(box, around, collider.keys);
  }
  for (const Collider& collider : scene.colliders)
    if (collider.shape == ColliderShape::plane && collider.normal.y > 0.7f) box.low.y = std::min(box.low.y, collider.centre.y);
  const Vec3 size = box.high - box.low;
  // Cloth swings away from its rest place.
  return {0.5f * (box.low + box.high), std::max(0.6f * length(size), 1e-3f)};
}

float tile_size(float radius) {
  const float wanted = 0.25f * radius, power = std::pow(10.0f, std::floor(std::log10(wanted)));
  for (float step : {1.0f, 2.0f, 5.0f})
    if (wanted <= 1.5f * step * power) return step * power;
  return 10 * power;
}

Solid solid_of(const Collider& collider, const ColliderPose& pose, const ColliderSize& size, const Frame& frame, Vec3 target, float tile) {
  Solid solid{};
  solid.colour = collider.colour;
  if (collider.shape != ColliderShape::plane) {
    const bool capsule = collider.shape == ColliderShape::capsule;
    const bool swallowed = capsule && std::abs(size.radius - size.radius_end) >= size.length;   // one end's sphere holds the other's
    const auto r = static_cast<float>(swallowed ? std::max(size.radius, size.radius_end) : size.radius);
    const Vec3 half = collider.shape == ColliderShape::box ? 0.5f * size.size : Vec3{r, r, r};
    solid.shape = swallowed ? WEFT_SHAPE_SPHERE : static_cast<std::uint32_t>(collider.shape);
    solid.axis_x = with_zero(rotated(pose.rotation, {half.x, 0, 0}));
    solid.axis_y = with_zero(rotated(pose.rotation, {0, half.y, 0}));
    solid.axis_z = with_zero(rotated(pose.rotation, {0, 0, half.z}));
    if (capsule) solid.end = static_cast<float>(0.5 * size.length / size.radius);
    if (capsule) solid.end_radius = static_cast<float>(size.radius_end / size.radius);
    const auto up = static_cast<float>(swallowed ? std::copysign(0.5 * size.length, size.radius_end - size.radius) : 0);
    solid.centre = with_zero(swallowed ? pose.centre + rotated(pose.rotation, {0, up, 0}) : pose.centre);
    solid.roughness = 0.45f;
    return solid;
  }
  const Vec3 normal = (1 / length(pose.normal)) * pose.normal;
  const Vec3 across = cross(normal, std::abs(normal.z) > 0.9f ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
  const Vec3 x = (1 / length(across)) * across, z = cross(x, normal);
  // The quad lies where the camera looks, a whole number of pattern periods from the plane's own point: so the pattern
  // moves with the plane and not with the camera.
  const float period = 2 * tile;
  const Vec3 away = target - pose.centre;
  const Vec3 centre = pose.centre + std::round(dot(away, x) / period) * period * x + std::round(dot(away, z) / period) * period * z;
  // Beyond three times `fade` only the horizon's colour is left.
  const float half = std::ceil((3 * frame.fade + length(target - frame.eye)) / period) * period;
  solid.shape = WEFT_SHAPE_PLANE;
  solid.axis_x = with_zero(half * x);
  solid.axis_y = with_zero(normal);
  solid.axis_z = with_zero(half * z);
  solid.centre = with_zero(centre);
  solid.roughness = 0.8f;
  solid.cell = tile;
  return solid;
}

std::uint32_t vertex_count(const Solid& solid) {
  if (solid.shape == WEFT_SHAPE_PLANE) return 6;
  return solid.shape == WEFT_SHAPE_BOX ? 36 : 6 * WEFT_SPHERE_SLICES * WEFT_SPHERE_STACKS;
}

}  // namespace weft::shading
