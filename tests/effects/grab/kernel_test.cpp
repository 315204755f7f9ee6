// grab against its twin in double precision, on any particles, hands and motions, and on what is degenerate.
#include <gtest/gtest.h>

#include "engine/effects/grab/grab.h"
#include "shaders/grab/grab.ref.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using KernelGrab = GpuTest;

constexpr std::uint32_t kGrabs = 8, kParticles = 60;

Scene grabbed_scene() {
  Scene scene = loose_scene(4);
  scene.grabs = kGrabs;
  return scene;
}

gpu::Grab any_grab(Random& random, const CookedFabric& fabric, std::uint32_t particle) {
  const auto target = [&] {
    const gpu::vec4 at = anywhere(random, 0.5, 0);
    return gpu::vec3{at.x, at.y, at.z};
  };
  const auto grip = [&] { return static_cast<float>(std::pow(10, between(random, -3, 7))); };
  return {particle, fabric.iterate_weights[particle], grip(), grip(), grip(), target(), target()};
}

TEST_F(KernelGrab, does_what_its_twin_does_with_every_grip_and_where_hands_share_a_particle) {
  Random random(3);
  const Scene scene = grabbed_scene();
  for (int trial = 0; trial < 20; ++trial) {
    CookedFabric fabric = loose_particles(random, kParticles, scene.solver);
    std::vector<gpu::Grab> grabs;
    for (std::uint32_t k = 0; k < 3 * kGrabs; ++k) {
      grabs.push_back(any_grab(random, fabric, random() % (trial < 10 ? kParticles : 6)));
      if (k % 7 == 6) grabs.back().particle = WEFT_NONE;
    }
    for (gpu::vec4& v : fabric.velocities) {
      const gpu::vec4 any = anywhere(random, 5, 0);
      v = {any.x, any.y, any.z, v.w};
    }
    for (const bool storage : {false, true}) {
      SinglePass passes(device(), scene, fabric, storage);
      FrameInput input = frame_of(4);
      input.grabs = grabs;
      passes.begin(input);
      passes.run("grab", 2);
      const auto velocities = passes.particles(buffers::velocities), iterate = passes.iterate();
      std::vector<reference::PulledParticle> wanted;
      std::vector<double> scale(kParticles, 1);
      for (std::uint32_t i = 0; i < kParticles; ++i) {
        const float w = fabric.positions[i].w;
        wanted.push_back({vector(fabric.velocities[i]), w > 0 ? 1 / double(w) : 0});
        scale[i] = wanted[i].velocity.norm() + 1;
      }
      for (const gpu::Grab& grab : grabs) {
        if (grab.particle == WEFT_NONE || fabric.positions[grab.particle].w == 0) continue;
        const reference::Vector from = vector(grab.from), to = vector(grab.to);
        const reference::Pull pull{grab.stiffness, grab.damping, grab.force, from + 0.75 * (to - from), (to - from) / (4 * fabric.h)};
        auto& particle = wanted[grab.particle];
        particle = reference::pulled(pull, vector(fabric.positions[grab.particle]), particle.velocity, particle.mass, fabric.h);
        scale[grab.particle] += pull.velocity.norm() + particle.velocity.norm() + 1 / fabric.h;   // a target is up to a metre off
      }
      for (std::uint32_t i = 0; i < kParticles; ++i) {
        EXPECT_LT((vector(velocities[i]) - wanted[i].velocity).norm(), 100 * kRounding * scale[i]) << i << " in trial " << trial;
        const double weight = fabric.positions[i].w > 0 ? fabric.iterate_weights[i] / (double(fabric.positions[i].w) * wanted[i].mass) : 0;
        EXPECT_NEAR(iterate[i].w, weight, 1e-4 * weight) << i;
      }
    }
  }
}

TEST_F(KernelGrab, no_hand_moves_what_is_held_or_not_finite_and_no_target_spoils_another) {
  Random random(4);
  const Scene scene = grabbed_scene();
  CookedFabric fabric = loose_particles(random, kParticles, scene.solver);
  fabric.positions[1].w = fabric.iterate_weights[1] = 0;
  fabric.positions[2].w = 2;
  fabric.positions[2].x = NAN;
  fabric.positions[3].w = 2;
  std::vector<gpu::Grab> grabs(3 * kGrabs, gpu::Grab{WEFT_NONE, 0, 0, 0, 0, {}, {}});
  for (std::uint32_t k = 0; k < 4; ++k) grabs[k] = {k, fabric.iterate_weights[k], 100, 1, 10, {0, 1, 0}, {0, 1, 0}};
  const gpu::vec4& there = fabric.positions[3];
  grabs[3].from = grabs[3].to = {there.x, there.y, there.z};   // no way to go: no direction
  fabric.velocities[3] = {0, 0, 0, fabric.velocities[3].w};
  SinglePass passes(device(), scene, fabric);
  FrameInput input = frame_of(1);
  input.grabs = grabs;
  passes.begin(input);
  passes.run("grab");
  const auto after = passes.particles(buffers::velocities);
  for (const std::uint32_t i : {1u, 2u, 3u}) EXPECT_EQ(vector(after[i]), vector(fabric.velocities[i])) << i;
  for (const gpu::vec4& v : after) EXPECT_TRUE(std::isfinite(v.x + v.y + v.z));
}

}  // namespace
}  // namespace weft
