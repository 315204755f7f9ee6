// The passes of second order in time against their twin, which knows both states before.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "engine/effects/bdf2/bdf2.h"
#include "shaders/bdf2/bdf2.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using Bdf2Kernel = GpuTest;

// Tolerances: a position of up to 1.8 m is rounded some dozen times on the way, and what is over the substep is velocity.

// Loose particles that have come from somewhere.
struct Moving {
  Scene scene;
  CookedFabric fabric;
  std::vector<reference::Motion> before;

  Moving(std::uint32_t substeps, std::uint32_t seed) {
    scene = loose_scene(substeps);
    scene.solver.order = 2;
    Random random(seed);
    fabric = loose_particles(random, 300, scene.solver);
    for (std::size_t k = 0; k < 2; ++k)
      fabric.materials[k].damping_factor = static_cast<float>(1 / (1 + kDampings[k] * solve_step(scene, fabric)));
    for (std::size_t i = 0; i < fabric.positions.size(); ++i) {
      const reference::Vector v = vector(anywhere(random, 2, 0)), off = 0.01 * vector(anywhere(random, 1, 0));
      before.push_back({vector(fabric.positions[i]) - fabric.h * vector(fabric.velocities[i]) - off, v});
    }
  }

  void put_steps(SinglePass& passes) const {
    std::vector<gpu::vec4> changes, remainders;
    const auto packed = [](const reference::Vector& v) {
      return gpu::vec4{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
    };
    for (std::size_t i = 0; i < before.size(); ++i) {
      const reference::Vector x = vector(fabric.positions[i]), v = vector(fabric.velocities[i]);
      changes.push_back(packed(v - before[i].velocity));
      remainders.push_back(packed(x - before[i].position - fabric.h * v));
    }
    passes.put(buffers::velocity_changes, changes);
    passes.put(buffers::step_remainders, remainders);
  }
};

TEST_F(Bdf2Kernel, predict_does_what_its_twin_does) {
  for (const bool gather_storage : {false, true}) {
    const Moving m(12, 1);
    SinglePass passes(device(), m.scene, m.fabric, gather_storage);
    m.put_steps(passes);
    passes.begin(falling(12));
    passes.run("predict");
    const auto predicted = passes.iterate(), velocities = passes.particles(buffers::velocities);
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      if (m.fabric.positions[i].w == 0) continue;
      const reference::Motion now{vector(m.fabric.positions[i]), vector(m.fabric.velocities[i])};
      const auto wanted = reference::predict_bdf2(m.before[i], now, kGravity, kDampings[i % 2], m.fabric.h);
      EXPECT_LT((vector(predicted[i]) - wanted.position).norm(), 16 * kRounding * 1.8);
      EXPECT_LT((vector(velocities[i]) - wanted.velocity).norm(), 16 * kRounding * 3.5);
    }
  }
}

// The first of several substeps, whose solve has moved all; what it ends with, and where the next one is predicted to lead.
TEST_F(Bdf2Kernel, a_substep_ends_as_its_twin_says_and_so_does_the_next_one) {
  const Moving m(3, 2);
  Random random(3);
  const auto p = moved(random, m.fabric, 0.02);
  SinglePass passes(device(), m.scene, m.fabric);
  m.put_steps(passes);
  passes.begin(falling(3));
  passes.run("predict");
  passes.put_iterate(p);
  passes.run("stretch");   // of no links: what is left is finalize
  const auto predicted = passes.iterate(), positions = passes.particles(buffers::positions);
  const auto velocities = passes.particles(buffers::velocities);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (m.fabric.positions[i].w == 0) continue;
    const reference::Vector x = vector(m.fabric.positions[i]), next = vector(p[i]);
    const reference::Motion now{x, vector(m.fabric.velocities[i])};
    // As the formula's velocity is linear in what the solve did: the prediction's, and 3 / 2h times the rest.
    const auto free_flight = reference::predict_bdf2(m.before[i], now, kGravity, kDampings[i % 2], m.fabric.h);
    const reference::Vector speed =
        free_flight.velocity + reference::velocity_bdf2(m.before[i].position, x, next, m.fabric.h) -
        reference::velocity_bdf2(m.before[i].position, x, free_flight.position, m.fabric.h);
    const auto after = reference::predict_bdf2(now, {next, speed}, kGravity, kDampings[i % 2], m.fabric.h);
    EXPECT_EQ(vector(positions[i]), next);
    EXPECT_LT((vector(velocities[i]) - after.velocity).norm(), 64 * kRounding / m.fabric.h) << i;
    EXPECT_LT((vector(predicted[i]) - after.position).norm(), 64 * kRounding) << i;
  }
}

// A floor under half of them: along its push the velocity is that of the way, and the rest, and what the next substep keeps of this one,
// is as without it.
TEST_F(Bdf2Kernel, a_push_by_a_collider_is_no_force) {
  Moving m(3, 4);
  m.scene.colliders = {plane(0, 0)};
  for (gpu::Material& material : m.fabric.materials) material.thickness = 0;
  Random random(5);
  const auto p = moved(random, m.fabric, 0.02);
  SinglePass passes(device(), m.scene, m.fabric);
  m.put_steps(passes);
  std::vector<gpu::Collider> colliders(1);
  colliders[0].normal_from = colliders[0].normal_to = {0, 1, 0};
  colliders[0].rotation_from.w = 1;
  FrameInput input = falling(3);
  input.colliders = colliders;
  passes.begin(input);
  passes.run("predict");
  passes.put_iterate(p);
  passes.run("stretch");
  const auto predicted = passes.iterate(), positions = passes.particles(buffers::positions);
  const auto velocities = passes.particles(buffers::velocities);
  std::size_t pushed = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (m.fabric.positions[i].w == 0 || vector(positions[i]) == vector(p[i])) continue;
    ++pushed;
    const double h = m.fabric.h, damping = kDampings[i % 2];
    const reference::Vector x = vector(m.fabric.positions[i]), end = vector(positions[i]);
    const reference::Motion now{x, vector(m.fabric.velocities[i])};
    const auto free_flight = reference::predict_bdf2(m.before[i], now, kGravity, damping, h);
    const reference::Vector solved = free_flight.velocity + 1.5 / h * (vector(p[i]) - free_flight.position);
    reference::Vector speed = solved;
    speed.y() = std::max((end.y() - x.y()) / h, solved.y());
    // The next substep is one after another that the push did not change: one that ended there with that velocity, and had begun slower or
    // faster by what the solve alone has changed.
    const reference::Motion before{x, speed - (solved - now.velocity)};
    const auto after = reference::predict_bdf2(before, {end, speed}, kGravity, damping, h);
    EXPECT_LT((vector(velocities[i]) - after.velocity).norm(), 64 * kRounding / h) << i;
    EXPECT_LT((vector(predicted[i]) - after.position).norm(), 64 * kRounding) << i;
  }
  EXPECT_GT(pushed, 50u);
}

}  // namespace
}  // namespace weft
