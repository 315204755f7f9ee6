// See samples/host_engine/world.h.
#include "samples/host_engine/world.h"

#include <cmath>
#include <numbers>

namespace host {
namespace {

using weft::Vec3;

float wave(double time, double period) { return static_cast<float>(std::sin(2 * std::numbers::pi * time / period)); }

}  // namespace

Vec3 beam(double time) { return {0.35f * wave(time, 5), 1.9f, 0.12f * wave(time, 3)}; }

// From behind the curtain through it to the front, and back again.
Vec3 ball(double time) { return {0.2f * wave(time, 5), 0.85f, -0.6f * wave(time + 0.77, 3.08)}; }

weft::Scene cloth_scene(double time) {
  weft::Scene scene;
  scene.name = "host_engine";
  weft::Cloth& curtain = scene.cloths.emplace_back();
  curtain.name = "curtain";
  curtain.grid = weft::Grid{kCurtainSize, 64, 60, weft::Topology::centre, true};
  curtain.transform.translate = beam(time) - Vec3{0, kCurtainSize.y / 2, 0};
  curtain.fabric = *weft::fabric_preset("silk");
  weft::Anchor& top = curtain.anchors.emplace_back();
  top.top = 0.001;
  top.every = 8;

  weft::Collider& sphere = scene.colliders.emplace_back();
  sphere.shape = weft::ColliderShape::sphere;
  sphere.centre = ball(time);
  sphere.radius = kBallRadius;
  sphere.friction = 0.2;
  scene.colliders.emplace_back();   // the floor: a plane through the origin, facing up
  return scene;
}

}  // namespace host
