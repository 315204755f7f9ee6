// What colliders are given against the twin, and the 64-bit sums: no order of threads, no negative and no degenerate particle spoils them.
#include <gtest/gtest.h>

#include <cstring>

#include "engine/effects/reaction/reaction.h"
#include "shaders/reaction/reaction.ref.h"
#include "tests/support/bodies.h"

namespace weft {
namespace {

using ReactionKernel = GpuTest;
using reference::Momentum;

struct Struck {
  Scene scene = loose_scene(4);
  std::vector<gpu::Collider> colliders;
  CookedFabric fabric;
  std::vector<gpu::vec4> iterate;
  std::vector<Momentum> wanted;   // of each collider
  double exchanged = 0;           // kg m/s, sizes of all impulses
  std::vector<std::size_t> spared;   // particles that meet none
};

// Loose particles and bodies of one shape. Those of which rounding decides whether they are met are held.
Struck struck(ColliderShape shape, double speed, std::uint64_t seed, bool tapered = false) {
  Random random(seed);
  Struck s;
  s.scene.reactions = true;
  s.colliders = bodies(random, shape, speed, tapered);
  s.scene.colliders.resize(s.colliders.size());
  for (Collider& described : s.scene.colliders) described.shape = shape;
  if (tapered) s.scene.colliders[0].radius_end = 0.1;
  s.fabric = loose_particles(random, 600, s.scene.solver);
  s.iterate = moved(random, s.fabric, 0.2);
  s.wanted.resize(s.colliders.size());
  const double gap = 16 * kRounding * (3 + speed);
  for (std::size_t i = 0; i < s.iterate.size(); ++i) {
    const gpu::Material& material = s.fabric.materials[i % 2];
    const reference::Vector x = vector(s.fabric.positions[i]);
    const double w = s.fabric.positions[i].w;
    reference::Vector now = vector(s.iterate[i]);
    std::vector<Momentum> given;
    bool decided = true;
    for (const gpu::Collider& c : s.colliders) {
      const reference::Body body = body_of(c, shape, kBodySubstep / 4.0, (kBodySubstep + 1) / 4.0, material.friction);
      decided &= !is_undecided(body, x, now, material.thickness, gap);
      const reference::Vector after = reference::out_of_body(body, x, now, material.thickness);
      given.push_back(reference::reaction(body.centre_after, now, after, w, s.fabric.h));
      now = after;
    }
    if (!decided) s.fabric.positions[i].w = s.fabric.iterate_weights[i] = 0;
    if (decided && w > 0 && now == vector(s.iterate[i])) s.spared.push_back(i);
    for (std::size_t k = 0; decided && k < given.size(); ++k) {
      s.wanted[k] += given[k];
      s.exchanged += given[k].linear.norm();
    }
  }
  return s;
}

std::vector<gpu::Reaction> sums_of(const compute::Device& device, const Struck& s, bool storage, std::uint32_t workgroup = 0) {
  SinglePass passes(device, s.scene, s.fabric, storage, workgroup);
  passes.put(buffers::velocities, leading_to(s.iterate, s.fabric));
  passes.put_iterate(s.iterate);
  FrameInput input = falling(4);
  input.colliders = s.colliders;
  passes.begin(input);
  passes.run("stretch", kBodySubstep);
  return passes.get<gpu::Reaction>(buffers::reactions, s.colliders.size());
}

bool same_sums(const std::vector<gpu::Reaction>& a, const std::vector<gpu::Reaction>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(gpu::Reaction)) == 0;
}

TEST_F(ReactionKernel, every_shape_is_given_what_its_twin_is) {
  constexpr std::pair<ColliderShape, bool> kBodies[] = {{ColliderShape::plane, false}, {ColliderShape::sphere, false},
                                                        {ColliderShape::capsule, false}, {ColliderShape::box, false},
                                                        {ColliderShape::capsule, true}};
  for (const auto& [shape, tapered] : kBodies)
    for (const double speed : {0.0, 0.2}) {
      SCOPED_TRACE(std::to_string(static_cast<int>(shape)) + (tapered ? ", tapered," : "") + " at " + std::to_string(speed) + " m/s");
      const Struck s = struck(shape, speed, 7 + static_cast<std::uint64_t>(shape), tapered);
      const auto sums = sums_of(device(), s, speed > 0);
      EXPECT_GT(s.exchanged, 10) << "the scene tests nothing";
      // Each place is off by rounding, 4 gaps of a body that is met obliquely at most; levers are some metres long.
      const double tolerance = 1e-5 * s.exchanged;
      for (std::size_t k = 0; k < sums.size(); ++k) {
        const Reaction got = reaction_between({}, sums[k], reaction_quantum(s.fabric));
        const auto gap = [](Vec3 a, const reference::Vector& b) { return (reference::Vector(a.x, a.y, a.z) - b).norm(); };
        EXPECT_LT(gap(got.impulse, s.wanted[k].linear), tolerance) << "collider " << k;
        EXPECT_LT(gap(got.angular_impulse, s.wanted[k].angular), 3 * tolerance) << "collider " << k;
      }
      EXPECT_TRUE(same_sums(sums_of(device(), s, speed == 0, 64), sums)) << "other threads, other bits";
    }
}

TEST_F(ReactionKernel, particles_that_are_not_finite_are_held_or_are_met_in_a_centre_spoil_no_sum) {
  Struck s = struck(ColliderShape::sphere, 0, 31);
  const auto sums = sums_of(device(), s, false);
  ASSERT_GE(s.spared.size(), 3u);
  s.iterate[s.spared[0]].x = NAN;
  s.iterate[s.spared[1]].y = INFINITY;
  s.iterate[s.spared[2]].z = 3e20f;
  EXPECT_TRUE(same_sums(sums_of(device(), s, false), sums));
  for (std::size_t i = 0; i < s.iterate.size(); ++i)
    if (s.fabric.positions[i].w == 0) {
      const gpu::vec3& c = s.colliders[0].centre_from;
      s.iterate[i] = {c.x, c.y, c.z, 0};
    }
  EXPECT_TRUE(same_sums(sums_of(device(), s, false), sums)) << "held ones in a sphere's centre";
}

TEST_F(ReactionKernel, a_heavy_particle_among_light_ones_carries_from_word_to_word) {
  Random random(2);
  Struck s;
  s.scene.reactions = true;
  s.scene.colliders = {Collider{}};
  s.fabric = loose_particles(random, 400, s.scene.solver);
  s.iterate = s.fabric.positions;
  gpu::Collider floor{};
  floor.normal_from = floor.normal_to = {0, 1, 0};
  floor.rotation_from = {0, 0, 0, 1};
  s.colliders = {floor};
  double wanted = 0;
  for (std::size_t i = 0; i < s.iterate.size(); ++i) {
    gpu::vec4& x = s.fabric.positions[i];
    x.w = s.fabric.split_weights[i] = s.fabric.iterate_weights[i] = i == 0 ? 0.01f : 1e5f;   // 100 kg, and 10 mg
    s.iterate[i].y = i == 0 ? -0.05f : -0.001f;
    wanted -= (0.002 - s.iterate[i].y) / (x.w * s.fabric.h);
  }
  const Reaction got = reaction_between({}, sums_of(device(), s, false)[0], reaction_quantum(s.fabric));
  EXPECT_NEAR(got.impulse.y, wanted, 1e-6 * -wanted);
}

}  // namespace
}  // namespace weft
