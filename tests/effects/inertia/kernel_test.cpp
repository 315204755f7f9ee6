// The pass inertia, with the map that the host makes for it, against its twin.
#include <gtest/gtest.h>

#include "engine/effects/inertia/inertia.h"
#include "shaders/inertia/inertia.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using KernelInertia = GpuTest;

MovingFrame any_frame(Random& random, double turn) {
  const Eigen::Vector3d axis(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1));
  const Eigen::Quaterniond q(Eigen::AngleAxisd(between(random, -turn, turn), axis.normalized()));
  const auto one = [&] { return static_cast<float>(between(random, -1, 1)); };
  const Eigen::Vector4f r = q.coeffs().cast<float>();
  return {{one(), one(), one()}, {r[0], r[1], r[2], r[3]}};
}

Eigen::Quaterniond wide(const Rotation& r) { return Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized(); }
reference::Vector wide(Vec3 v) { return {v.x, v.y, v.z}; }

// Three poses of a frame, in times that differ; the second cloth's stands still, and its factors are of no effect.
TEST_F(KernelInertia, does_what_its_twin_does) {
  Random random(21);
  for (const bool storage : {false, true})
    for (const double turn : {0.0, 0.01, 1.0}) {
      Scene scene = loose_scene(1);
      scene.cloths.resize(2);
      const Inertia factors{between(random, 0, 1), between(random, 0, 1), between(random, 0, 1), ""};
      scene.cloths[0].inertia = factors;
      const CookedFabric fabric = loose_particles(random, 512, scene.solver);
      const MovingFrame a = any_frame(random, turn), b = any_frame(random, turn), c = any_frame(random, turn);
      const double first = 1.0 / 60, second = 1.0 / 48;
      const gpu::FrameChange changes[] = {change_of(factors, b, motion_between(a, b, first), motion_between(b, c, second)),
                                          change_of(Inertia{0, 0, 0, ""}, b, {}, {})};
      SinglePass passes(device(), scene, fabric, storage);
      FrameInput input = frame_of(1);
      input.frame_changes = changes;
      passes.begin(input);
      passes.run("inertia");
      const auto velocities = passes.particles(buffers::velocities);
      const auto way = [](const MovingFrame& from, const MovingFrame& to) { return reference::Vector(wide(to.place) - wide(from.place)); };
      const reference::FrameMotion before{way(a, b), wide(b.rotation) * wide(a.rotation).conjugate(), first};
      const reference::FrameMotion next{way(b, c), wide(c.rotation) * wide(b.rotation).conjugate(), second};
      for (std::size_t i = 0; i < velocities.size(); ++i) {
        const reference::Vector w = vector(fabric.velocities[i]);
        const reference::Vector wanted =
            fabric.positions[i].w == 0 || i % 2 == 1
                ? w
                : reference::without_inertia(vector(fabric.positions[i]), w, wide(b.place), before, next,
                                             factors.linear, factors.angular, factors.centrifugal);
        // m/s; frames are placed to float precision, over a sixtieth of a second.
        EXPECT_LT((vector(velocities[i]) - wanted).norm(), 2e-4) << i;
        EXPECT_EQ(std::memcmp(&velocities[i].w, &fabric.velocities[i].w, 4), 0);
      }
    }
}

// A map that is not finite, or beyond what can be squared, changes nothing.
TEST_F(KernelInertia, what_is_beyond_floats_is_left_out) {
  Random random(22);
  Scene scene = loose_scene(1);
  scene.cloths.resize(2);
  scene.cloths[0].inertia.emplace();
  const CookedFabric fabric = loose_particles(random, 64, scene.solver);
  gpu::FrameChange changes[2]{};
  changes[0].b = {INFINITY, 0, 0};
  changes[1].b = {0, 2e10f, 0};
  SinglePass passes(device(), scene, fabric);
  FrameInput input = frame_of(1);
  input.frame_changes = changes;
  passes.begin(input);
  passes.run("inertia");
  const auto velocities = passes.particles(buffers::velocities);
  EXPECT_EQ(std::memcmp(velocities.data(), fabric.velocities.data(), velocities.size() * sizeof velocities[0]), 0);
}

}  // namespace
}  // namespace weft
