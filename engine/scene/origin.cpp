#include "engine/scene/origin.h"

#include <algorithm>
#include <cmath>

#include "engine/fabric.h"

namespace weft {

Vec3 origin_near(std::span<const Mesh> meshes) {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  for (const Mesh& mesh : meshes)
    for (const Vec3& p : mesh.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  const auto whole_steps = [](float a, float b) {
    const float steps = std::round((a / 2 + b / 2) / kOriginStep);
    return std::isfinite(steps) ? steps * kOriginStep + 0.0f : 0.0f;   // -0 is 0
  };
  return {whole_steps(low.x, high.x), whole_steps(low.y, high.y), whole_steps(low.z, high.z)};
}

Scene relative_to(Scene scene, Vec3 origin) {
  for (Cloth& cloth : scene.cloths) {
    cloth.transform.translate = cloth.transform.translate - origin;
    for (Anchor& anchor : cloth.anchors)
      if (anchor.box) anchor.box = Anchor::Box{anchor.box->low - origin, anchor.box->high - origin};
  }
  if (scene.air)
    for (Air::Field& field : scene.air->fields) field.centre = field.centre - origin;
  for (Collider& collider : scene.colliders) collider.centre = collider.centre - origin;
  return scene;
}

Result<Near> recentred(const Scene& scene) {
  auto meshes = make_meshes(scene);
  if (!meshes) return meshes.take_error();
  Near near{scene, std::move(*meshes), {}};
  near.origin = origin_near(std::span(near.meshes).first(scene.cloths.size()));
  if (near.origin == Vec3{}) return near;
  near.scene = relative_to(scene, near.origin);
  meshes = make_meshes(near.scene);
  if (!meshes) return meshes.take_error();
  near.meshes = std::move(*meshes);
  return near;
}

}  // namespace weft
