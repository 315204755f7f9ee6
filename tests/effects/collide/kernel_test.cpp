// Colliders of every shape against their twins: still and fast, turning, met from outside, inside and in passing.
#include <gtest/gtest.h>

#include <cmath>

#include "shaders/collide/collide.ref.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using CollideKernel = GpuTest;

constexpr int kSubstep = 2;   // of four

// Random bodies of one shape that move, and spin or tilt.
std::vector<gpu::Collider> bodies(Random& random, ColliderShape shape, double speed) {
  std::vector<gpu::Collider> colliders;
  const auto one = [&](double low, double high) { return static_cast<float>(between(random, low, high)); };
  for (int k = 0; k < 3; ++k) {
    gpu::Collider c{};
    c.radius = one(0.2, shape == ColliderShape::capsule ? 0.5 : 0.8);
    c.friction = one(0, 1);
    c.half_size = {one(0.2, 0.4), one(0.4, 0.9), one(0.4, 0.9)};
    const gpu::vec4 way = anywhere(random, speed, 0);
    gpu::vec4 midway = anywhere(random, 1, 0);
    if (shape == ColliderShape::plane) midway.y = -1 + 0.3f * midway.y;
    const auto at = [&](float fraction) {   // kSubstep is where the body is among the particles
      const float t = fraction - (kSubstep + 0.5f) / 4;
      return gpu::vec3{midway.x + t * way.x, midway.y + t * way.y, midway.z + t * way.z};
    };
    c.centre_from = at(0);
    c.centre_to = at(1);
    const auto tilted = [&](double size) {
      const reference::Vector n = (reference::Vector::UnitY() + vector(anywhere(random, size, 0))).normalized();
      return gpu::vec3{static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z())};
    };
    c.normal_from = tilted(0.3);
    c.normal_to = tilted(0.3);
    const gpu::vec4 spin = anywhere(random, 1, 0);
    c.spin = {spin.x, spin.y, spin.z};
    const Eigen::Quaternionf q = Eigen::Quaternionf(one(-1, 1), one(-1, 1), one(-1, 1), one(-1, 1)).normalized();
    c.rotation_from = {q.x(), q.y(), q.z(), q.w()};
    colliders.push_back(c);
  }
  return colliders;
}

reference::Body body_of(const gpu::Collider& c, ColliderShape shape, double from, double to, double cloth_friction) {
  const auto centre = [&](double t) { return reference::Vector((1 - t) * vector(c.centre_from) + t * vector(c.centre_to)); };
  const auto normal = [&](double t) { return reference::Vector((1 - t) * vector(c.normal_from) + t * vector(c.normal_to)).normalized(); };
  const auto rotation = [&](double t) {
    const reference::Vector spin = vector(c.spin);
    const Eigen::Quaterniond start(c.rotation_from.w, c.rotation_from.x, c.rotation_from.y, c.rotation_from.z);
    if (spin.norm() == 0) return start;
    return Eigen::Quaterniond(Eigen::AngleAxisd(t * spin.norm(), spin.normalized())) * start;
  };
  reference::Body body;
  body.shape = static_cast<reference::Shape>(shape);
  body.centre_before = centre(from);
  body.centre_after = centre(to);
  body.normal_before = normal(from);
  body.normal_after = normal(to);
  body.radius = c.radius;
  body.half_size = vector(c.half_size);
  body.rotation_before = rotation(from);
  body.rotation_after = rotation(to);
  body.turn = (to - from) * vector(c.spin);
  body.friction = std::sqrt(c.friction * cloth_friction);
  return body;
}

// Just missed or just hit, this face or the next: that makes all the difference. A particle whose place leaps when its way is
// stirred by rounding's size is not compared: half the tolerance after a sixteenth of it.
bool is_undecided(const reference::Body& body, const reference::Vector& x, const reference::Vector& p, double thickness, double gap) {
  const reference::Vector undisturbed = reference::out_of_body(body, x, p, thickness);
  for (int k = 0; k < 12; ++k) {
    const reference::Vector stir = (k % 2 == 0 ? gap : -gap) / 16 * reference::Vector::Unit(k / 2 % 3);
    const auto there = k < 6 ? reference::out_of_body(body, x + stir, p, thickness) : reference::out_of_body(body, x, p + stir, thickness);
    if ((there - undisturbed).norm() > gap / 2) return true;
  }
  return false;
}

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
  passes.run("stretch", kSubstep);
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
      const reference::Body body = body_of(c, shape, kSubstep / 4.0, (kSubstep + 1) / 4.0, material.friction);
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
