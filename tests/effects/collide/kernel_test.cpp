// Colliders of every shape against their twins: still and fast, turning, met from outside, inside and in passing.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/effects/support/support.h"
#include "shaders/support/support.ref.h"
#include "tests/support/bodies.h"

namespace weft {
namespace {

using CollideKernel = GpuTest;

void compare_colliders(const compute::Device& device, ColliderShape shape, double speed, bool fast_particles, std::uint64_t seed,
                       bool tapered = false) {
  Random random(seed);
  Scene scene = loose_scene(4);
  const auto colliders = bodies(random, shape, speed, tapered);
  scene.colliders.resize(colliders.size());
  for (Collider& described : scene.colliders) described.shape = shape;
  if (tapered) scene.colliders[0].radius_end = 0.1;   // that one is, whatever its radii
  CookedFabric fabric = loose_particles(random, 600, scene.solver);
  fabric.own.of<SupportLists>().holds = true;
  const auto p = moved(random, fabric, fast_particles ? 1 : 0.03);
  SinglePass passes(device, scene, fabric, seed % 2 == 0);
  passes.put(buffers::velocities, leading_to(p, fabric));
  passes.put_iterate(p);
  // What the solve has held back of a third counts as depth for friction.
  std::vector<gpu::vec4> supports(p.size());
  for (std::size_t i = 0; i < p.size(); i += 3) supports[i] = anywhere(random, 0.001, static_cast<float>(between(random, -0.02, 0.04)));
  passes.put(buffers::supports, supports);
  reference::Points held;
  for (const gpu::vec4& s : supports) held.push_back(s.w == 0 ? reference::Vector(reference::Vector::Zero()) : s.w * vector(s).normalized());
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
  reference::Points renewed;   // supports, of planes: other bodies may have put a particle out where it entered
  for (std::size_t i = 0; i < p.size(); ++i) {
    const gpu::Material& material = fabric.materials[i % 2];
    const reference::Vector x = vector(fabric.positions[i]);
    reference::Vector now = vector(p[i]);
    bool decided = true;
    reference::Vector put_out = reference::Vector::Zero();
    for (const gpu::Collider& c : colliders) {
      if (fabric.positions[i].w == 0) continue;
      const reference::Body body = body_of(c, shape, kBodySubstep / 4.0, (kBodySubstep + 1) / 4.0, material.friction);
      decided &= !is_undecided(body, x, now, material.thickness, gap);
      const reference::Vector after = reference::out_of_body(body, x, now, material.thickness, held[i]);
      touched += decided && after != now;
      if (const double depth = material.thickness - reference::signed_distance(body, now); depth > 0)
        put_out += depth * reference::distance_gradient(body, now);
      now = after;
    }
    renewed.push_back(reference::renewed(vector(supports[i]), supports[i].w, put_out));
    compared.push_back(decided);
    wanted.push_back(now);
  }
  EXPECT_GT(touched, tapered ? 30 : 50) << "the scene tests nothing";
  const auto positions = passes.particles(buffers::positions), velocities = passes.particles(buffers::velocities);
  const auto supports_now = passes.particles(buffers::supports);
  int left_out = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!compared[i]) {
      ++left_out;
      continue;
    }
    ASSERT_LT((vector(positions[i]) - wanted[i]).norm(), tolerance)
        << "particle " << i << ", shape " << static_cast<int>(shape) << ", speed " << speed;
    if (fabric.positions[i].w == 0) continue;
    if (shape == ColliderShape::plane) {
      ASSERT_LT((vector(supports_now[i]) - renewed[i]).norm(), tolerance) << "particle " << i;
      ASSERT_EQ(supports_now[i].w, 0);
    }
    const auto speed_now = reference::velocity(vector(fabric.positions[i]), wanted[i], fabric.h);
    const auto after = reference::predict({wanted[i], speed_now}, kGravity, kDampings[i % 2], fabric.h, false);
    ASSERT_LT((vector(velocities[i]) - after.velocity).norm(), 2 * tolerance / fabric.h) << "particle " << i;
  }
  EXPECT_LT(left_out, tapered ? 90 : 60);   // a tenth, where fast bodies are met in passing; hardly any elsewhere
}

TEST_F(CollideKernel, planes_do_what_their_twin_does) {
  for (const double speed : {0.0, 0.2}) {
    compare_colliders(device(), ColliderShape::plane, speed, false, 11);
    compare_colliders(device(), ColliderShape::plane, speed, true, 12);
  }
}

// A support that is not finite would stay so, and hold back whoever shares a node with it.
TEST_F(CollideKernel, what_is_not_finite_is_not_held) {
  Random random(13);
  Scene scene = loose_scene(4);
  const auto colliders = bodies(random, ColliderShape::plane, 0);
  scene.colliders.resize(colliders.size());
  CookedFabric fabric = loose_particles(random, 600, scene.solver);
  fabric.own.of<SupportLists>().holds = true;
  auto p = moved(random, fabric, 0.03);
  for (std::size_t i = 0; i < p.size(); i += 5) p[i].y = i % 2 == 0 ? NAN : INFINITY;
  SinglePass passes(device(), scene, fabric);
  passes.put_iterate(p);
  std::vector<gpu::vec4> supports(p.size());
  for (gpu::vec4& support : supports) support = anywhere(random, 0.001, 0.001f);
  supports[0].w = NAN;
  passes.put(buffers::supports, supports);
  FrameInput input = falling(4);
  input.colliders = colliders;
  passes.begin(input);
  passes.run("stretch", kBodySubstep);
  for (const gpu::vec4& support : passes.particles(buffers::supports)) {
    ASSERT_TRUE(std::isfinite(support.x + support.y + support.z));
    ASSERT_EQ(support.w, 0);
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

TEST_F(CollideKernel, capsules_with_two_radii_do_what_their_twin_does_inside_outside_and_swept) {
  for (const double speed : {0.0, 0.2, 20.0}) {
    compare_colliders(device(), ColliderShape::capsule, speed, false, 51, true);
    compare_colliders(device(), ColliderShape::capsule, speed, true, 52, true);
  }
}

// With the code for two radii, by their distance from each other alone: as with the code for one.
TEST_F(CollideKernel, capsules_of_equal_radii_beside_one_with_two_do_what_their_twin_does) {
  Random random(61);
  Scene scene = loose_scene(4);
  scene.colliders.resize(1);
  scene.colliders[0].shape = ColliderShape::capsule;
  scene.colliders[0].radius_end = 0.1;
  const CookedFabric fabric = loose_particles(random, 600, scene.solver);
  const auto p = moved(random, fabric, 0.1);
  const auto colliders = bodies(random, ColliderShape::capsule, 0.5);
  std::vector<std::vector<gpu::vec4>> ends;
  for (const bool tapered : {true, false}) {
    if (!tapered) scene.colliders[0].radius_end.reset();
    SinglePass passes(device(), scene, fabric);
    passes.put(buffers::velocities, leading_to(p, fabric));
    passes.put_iterate(p);
    FrameInput input = falling(4);
    input.colliders = std::span(colliders).first(1);
    passes.begin(input);
    passes.run("stretch", kBodySubstep);
    ends.push_back(passes.particles(buffers::positions));
  }
  int touched = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_LT((vector(ends[0][i]) - vector(ends[1][i])).norm(), 64 * kRounding) << "particle " << i;
    touched += (vector(ends[1][i]) - vector(p[i])).norm() > 1e-3;
  }
  EXPECT_GT(touched, 20);
}

// Particles on the axis, in ends' centres and where the side begins; held by none.
TEST_F(CollideKernel, a_particle_on_the_axis_of_two_radii_comes_out) {
  constexpr double length = 0.4;
  // The last three: an end in the other, one that touches it from inside, one that hardly sticks out.
  const double kPairs[][2] = {{0.3, 0.1}, {0.1, 0.3}, {0.1, 0.6}, {0.5, 0.1}, {0.45, 0.0501}};
  for (const auto& [low, high] : kPairs) {
    SCOPED_TRACE("radii " + std::to_string(low) + " and " + std::to_string(high));
    Random random(4);
    Scene scene = loose_scene(1);
    scene.colliders.emplace_back().shape = ColliderShape::capsule;
    scene.colliders[0].radius_end = 0.1;
    CookedFabric fabric = loose_particles(random, 41, scene.solver);
    for (std::size_t i = 0; i < 41; ++i) {
      fabric.positions[i] = {0, 0.02f * (static_cast<float>(i) - 20), 0, 1};
      fabric.iterate_weights[i] = fabric.split_weights[i] = 1;
    }
    SinglePass passes(device(), scene, fabric);
    passes.put_iterate(fabric.positions);
    gpu::Collider body{};
    const gpu::BodySize size = body_size(ColliderShape::capsule, {low, high, length, {}});
    body.radius = size.radius;
    body.half_size = size.half_size;
    body.normal_from = body.normal_to = {0, 1, 0};
    body.rotation_from = {0, 0, 0, 1};
    FrameInput input = frame_of(1);
    input.colliders = std::span(&body, 1);
    passes.begin(input);
    passes.run("stretch");
    const reference::Body twin{.shape = reference::Shape::capsule, .radius = low, .taper = low - high, .half_size = {0, 0.5 * length, 0}};
    const auto positions = passes.particles(buffers::positions);
    for (std::size_t i = 0; i < 41; ++i) {
      const double thickness = fabric.materials[i % 2].thickness;
      const double before = reference::signed_distance(twin, vector(fabric.positions[i]));
      EXPECT_NEAR(reference::signed_distance(twin, vector(positions[i])), std::max(before, thickness), 1e-5) << "particle " << i;
    }
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
