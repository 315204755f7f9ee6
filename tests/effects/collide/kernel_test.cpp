// Colliders of every shape against their twins: still and fast, turning, met from outside, inside and in passing.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/bodies.h"

namespace weft {
namespace {

using CollideKernel = GpuTest;

void compare_colliders(const compute::Device& device, ColliderShape shape, double speed, bool fast_particles, std::uint64_t seed) {
  Random random(seed);
  Scene scene = loose_scene(4);
  const auto colliders = bodies(random, shape, speed);
  scene.colliders.resize(colliders.size());
  for (Collider& described : scene.colliders) described.shape = shape;
  const CookedFabric fabric = loose_particles(random, 600, scene.solver);
  const auto p = moved(random, fabric, fast_particles ? 1 : 0.03);
  SinglePass passes(device, scene, fabric, seed % 2 == 0);
  passes.put(buffers::velocities, leading_to(p, fabric));
  passes.put_iterate(p);
  FrameInput input = falling(4);
  input.colliders = colliders;
  passes.begin(input);
  passes.run("stretch", kBodySubstep);
  const double gap = 16 * kRounding * (3 + speed);   // coordinates up to 3 m, of bodies as far as they go in a frame
  // A round side met obliquely multiplies rounding, by as much as is_undecided lets pass, and the next body once more.
  const double tolerance = shape == ColliderShape::capsule ? 4 * gap : gap;
  reference::Points wanted;
  int touched = 0;
  std::vector<bool> compared;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const gpu::Material& material = fabric.materials[i % 2];
    const reference::Vector x = vector(fabric.positions[i]);
    reference::Vector now = vector(p[i]);
    bool decided = true;
    for (const gpu::Collider& c : colliders) {
      if (fabric.positions[i].w == 0) continue;
      const reference::Body body = body_of(c, shape, kBodySubstep / 4.0, (kBodySubstep + 1) / 4.0, material.friction);
      decided &= !is_undecided(body, x, now, material.thickness, gap);
      const reference::Vector after = reference::out_of_body(body, x, now, material.thickness);
      touched += decided && after != now;
      now = after;
    }
    compared.push_back(decided);
    wanted.push_back(now);
  }
  EXPECT_GT(touched, 50) << "the scene tests nothing";
  const auto positions = passes.particles(buffers::positions), velocities = passes.particles(buffers::velocities);
  int left_out = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!compared[i]) {
      ++left_out;
      continue;
    }
    ASSERT_LT((vector(positions[i]) - wanted[i]).norm(), tolerance)
        << "particle " << i << ", shape " << static_cast<int>(shape) << ", speed " << speed;
    if (fabric.positions[i].w == 0) continue;
    const auto speed_now = reference::velocity(vector(fabric.positions[i]), wanted[i], fabric.h);
    const auto after = reference::predict({wanted[i], speed_now}, kGravity, kDampings[i % 2], fabric.h, false);
    ASSERT_LT((vector(velocities[i]) - after.velocity).norm(), 2 * tolerance / fabric.h) << "particle " << i;
  }
  EXPECT_LT(left_out, 60);   // a tenth, where fast bodies are met in passing; hardly any elsewhere
}

TEST_F(CollideKernel, planes_do_what_their_twin_does) {
  for (const double speed : {0.0, 0.2}) {
    compare_colliders(device(), ColliderShape::plane, speed, false, 11);
    compare_colliders(device(), ColliderShape::plane, speed, true, 12);
  }
}

TEST_F(CollideKernel, spheres_do_what_their_twin_does_inside_outside_and_swept) {
  for (const double speed : {0.0, 0.2, 20.0}) {   // 5 m in this substep
    compare_colliders(device(), ColliderShape::sphere, speed, false, 21);
    compare_colliders(device(), ColliderShape::sphere, speed, true, 22);
  }
}

TEST_F(CollideKernel, capsules_do_what_their_twin_does_inside_outside_and_swept) {
  for (const double speed : {0.0, 0.2, 20.0}) {
    compare_colliders(device(), ColliderShape::capsule, speed, false, 31);
    compare_colliders(device(), ColliderShape::capsule, speed, true, 32);
  }
}

TEST_F(CollideKernel, boxes_do_what_their_twin_does_inside_outside_and_swept) {
  for (const double speed : {0.0, 0.2, 20.0}) {
    compare_colliders(device(), ColliderShape::box, speed, false, 41);
    compare_colliders(device(), ColliderShape::box, speed, true, 42);
  }
}

TEST_F(CollideKernel, a_particle_in_a_spheres_centre_comes_out_on_top) {
  Random random(3);
  Scene scene = loose_scene(1);
  scene.colliders.emplace_back().shape = ColliderShape::sphere;
  CookedFabric fabric = loose_particles(random, 8, scene.solver);
  fabric.positions[0] = {0.25f, 0.5f, -0.5f, 1};
  SinglePass passes(device(), scene, fabric);
  passes.put_iterate(fabric.positions);
  gpu::Collider ball{};
  ball.radius = 0.5f;
  ball.centre_from = ball.centre_to = {0.25f, 0.5f, -0.5f};
  ball.normal_from = ball.normal_to = {0, 1, 0};
  FrameInput input = frame_of(1);
  input.colliders = std::span(&ball, 1);
  passes.begin(input);
  passes.run("stretch");
  EXPECT_LT((vector(passes.particles(buffers::positions)[0]) - reference::Vector(0.25, 1.002, -0.5)).norm(), 8 * kRounding);
}

}  // namespace
}  // namespace weft
