// The scene that a bare mesh gets.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/scene.h"

namespace weft {

namespace {

// A sheet that lies flat has no top to hang from: hold the strip along its far edge instead.
Anchor top_of(Vec3 low, Vec3 high) {
  constexpr double kStrip = 0.02;  // of the height: one row of vertices on any mesh of up to fifty rows, a few on finer ones
  const Vec3 size = high - low;
  const float widest = std::max(size.x, size.z);
  Anchor anchor;
  if (size.y > 0.01f * widest) {
    anchor.top = kStrip * size.y;
  } else {
    const float margin = 0.01f * widest;
    anchor.box = Anchor::Box{{low.x - margin, low.y - margin, low.z - margin},
                             {high.x + margin, high.y + margin, low.z + static_cast<float>(kStrip) * size.z}};
  }
  return anchor;
}

}  // namespace

Scene default_scene(const std::filesystem::path& mesh, Vec3 low, Vec3 high) {
  Scene scene;
  scene.name = mesh.stem().string();
  scene.folder = mesh.parent_path();
  scene.frames = 300;

  Cloth& cloth = scene.cloths.emplace_back();
  cloth.name = scene.name;
  cloth.mesh = mesh.filename().string();
  cloth.anchors.push_back(top_of(low, high));
  cloth.appearance.base_colour = {0.5f, 0.16f, 0.12f};  // stands out from a grey floor
  cloth.appearance.mesh_materials = true;

  const Vec3 size = high - low;
  const float largest = std::max({size.x, size.y, size.z});
  Collider& floor = scene.colliders.emplace_back();
  floor.shape = ColliderShape::plane;
  // A flat sheet swings down by its own length once it is let go.
  const float drop = size.y > 0.01f * largest ? 0.15f * size.y : 1.15f * largest;
  floor.centre = {(low.x + high.x) / 2, low.y - drop, (low.z + high.z) / 2};

  // Everything from the floor to the top fits a cone of the field of view around the sphere that holds it.
  const Vec3 bottom{low.x, floor.centre.y, low.z};
  const float radius = std::max(0.5f * length(high - bottom), 1e-3f);
  const Vec3 middle = 0.5f * (high + bottom);
  const double distance = 1.05 * radius / std::sin(scene.camera.fov_degrees / 2 * std::numbers::pi / 180);
  const Vec3 view{0.35f, 0.3f, 1};
  scene.camera.target = middle;
  scene.camera.eye = middle + (static_cast<float>(distance) / length(view)) * view;
  return scene;
}

}  // namespace weft
