// Mass-spring and Verlet on the GPU: the shader against its twin, the longest stable step, and what becomes of a longer one.
#include <gtest/gtest.h>

#include "shaders/motion/motion.ref.h"
#include "shaders/spring/spring.ref.h"
#include "tests/support/cooked.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using MassSpring = GpuTest;

// The WebGL scarf's springs, 12 neighbours each, pinned along its top.
Scene scarf(std::uint32_t cells, double h) {
  Scene scene = sheet(cells);
  scene.solver.method = Method::mass_spring;
  scene.solver.rate = 1 / (5 * h);
  scene.solver.substeps = 5;
  Cloth& cloth = scene.cloths[0];
  cloth.grid->size = {0.2f * static_cast<float>(cells), 0.2f * static_cast<float>(cells)};
  cloth.grid->upright = true;
  cloth.tethers = false;
  cloth.springs = Springs{.structural = {15000, 1}, .shear = {15000, 1}, .bend = {15000, 1}, .mass = 0.65};
  cloth.anchors.emplace_back().top = 0;
  return scene;
}

std::string refusal(const Scene& scene) {
  const auto fabric = cook(scene, must(make_meshes(scene)));
  return fabric ? "" : fabric.error();
}

TEST_F(MassSpring, springs_join_12_neighbours_and_with_verlet_8_that_only_pull) {
  Scene scene = scarf(8, 0.003);
  const auto links_of_the_middle = [&] {
    const CookedFabric fabric = cooked(scene);
    std::vector<ParticleSpring> found;
    for (const ParticleSpring& s : fabric.springs)
      for (const std::uint32_t end : {s.a, s.b})
        if (std::hypot(fabric.positions[end].x, fabric.positions[end].y) < 1e-3) found.push_back(s);
    return found;
  };
  EXPECT_EQ(links_of_the_middle().size(), 12u);
  scene.solver.method = Method::verlet;
  scene.cloths[0].springs->bend = {};
  EXPECT_EQ(links_of_the_middle().size(), 8u);
  for (const ParticleSpring& spring : links_of_the_middle()) EXPECT_TRUE(spring.only_pulls);
}

TEST_F(MassSpring, a_pass_does_what_its_twin_does_on_crumpled_sheets) {
  Random random(4);
  for (const Method method : {Method::mass_spring, Method::verlet})
    for (const bool own : {true, false}) {   // springs of the scene's, or the fabric's links and bends
      Scene scene = scarf(9, 0.001);
      scene.solver.method = method;
      if (method == Method::verlet) scene.cloths[0].springs->bend = {};
      if (!own) {
        scene.cloths[0].springs.reset();
        scene.cloths[0].fabric.stretch = 100;
        scene.cloths[0].fabric.area_density = 10;
      }
      CookedFabric fabric = cooked(scene);
      for (gpu::vec4& x : fabric.positions) {
        const gpu::vec4 d = anywhere(random, 0.05, 0);
        x = {x.x + d.x, x.y + d.y, x.z + d.z, x.w};
      }
      for (gpu::vec4& v : fabric.velocities) v = anywhere(random, 1, v.w);
      SinglePass passes(device(), scene, fabric, own);
      passes.put_iterate(fabric.positions);
      passes.begin(frame_of(1));
      passes.run("spring");
      std::vector<reference::DampedSpring> springs;
      for (const ParticleSpring& s : fabric.springs) springs.push_back({s.a, s.b, s.rest, s.stiffness, s.damping, s.only_pulls});
      const reference::Points x = points(fabric.positions);
      const auto twin = reference::push_springs(springs, x, x, points(fabric.velocities), inverse_masses(fabric), fabric.h);
      // Rounding of lengths up to 2 m, times h^2 k / m below 1, summed over up to 40 springs; and of the places themselves.
      EXPECT_LT(largest_gap(passes.iterate(), twin), 40 * kRounding * 2) << static_cast<int>(method) << own;
      EXPECT_EQ(passes.counters().coincident, 0u);
    }
}

// Left alone they would stay together as long as everything else does the same to both.
TEST_F(MassSpring, ends_at_one_place_are_counted_and_pushed_apart) {
  const Scene scene = scarf(4, 0.001);
  CookedFabric fabric = cooked(scene);
  const auto joined = std::find_if(fabric.springs.begin(), fabric.springs.end(),
                                   [&](const ParticleSpring& s) { return fabric.positions[s.a].w > 0 && fabric.positions[s.b].w > 0; });
  ASSERT_NE(joined, fabric.springs.end());
  gpu::vec4 &a = fabric.positions[joined->a], &b = fabric.positions[joined->b];
  b = {a.x, a.y, a.z, b.w};
  fabric.velocities[joined->a].x = 1;   // m/s: between ends at one place nothing is damped
  SinglePass passes(device(), scene, fabric, true);
  passes.put_iterate(fabric.positions);
  passes.begin(frame_of(1));
  passes.run("spring");
  EXPECT_EQ(passes.counters().coincident, 2u) << "once at either end";
  std::vector<reference::DampedSpring> springs;
  for (const ParticleSpring& s : fabric.springs) springs.push_back({s.a, s.b, s.rest, s.stiffness, s.damping, s.only_pulls});
  const reference::Points x = points(fabric.positions), v = points(fabric.velocities);
  EXPECT_LT(largest_gap(passes.iterate(), reference::push_springs(springs, x, x, v, inverse_masses(fabric), fabric.h)), 40 * kRounding * 2);
  const auto after = passes.iterate();
  const gpu::vec4 &p = after[joined->a], &q = after[joined->b];
  EXPECT_GT(std::hypot(p.x - q.x, p.y - q.y, p.z - q.z), 1e-4 * joined->rest);
}

// Two particles on a spring: w = sqrt(2 k / m), h < 2 / w. With damping c the limit is the root of 2 h C + h^2 A = 4.
TEST_F(MassSpring, the_longest_step_of_a_grid_is_that_of_its_quickest_wave) {
  const CookedFabric fabric = cooked(scarf(30, 0.001));
  // Over all waves (kx, ky) of an endless grid, of what 12 springs pull at most.
  double largest = 0;
  for (double kx = 0; kx < 3.15; kx += 0.02)
    for (double ky = 0; ky < 3.15; ky += 0.02)
      largest = std::max(
          largest, 2 * (6 - std::cos(kx) - std::cos(ky) - std::cos(kx + ky) - std::cos(kx - ky) - std::cos(2 * kx) - std::cos(2 * ky)));
  const double a = largest * 15000 / 0.65, c = largest / 0.65;
  const double limit = 4 / (c + std::sqrt(c * c + 4 * a));
  // The border lets no wave be quicker; engine/effects/spring/longest_step.cpp takes a margin of 5 % on stiffness, half of it on the step.
  EXPECT_LT(fabric.largest_step, limit);
  EXPECT_GT(fabric.largest_step, 0.96 * limit);
}

// Nothing makes energy: what the sheet has in motion stays below what gravity gave it.
TEST_F(MassSpring, a_sheet_just_below_its_longest_step_stays_calm) {
  Scene scene = scarf(20, 0.001);
  const double longest = cooked(scene).largest_step;
  scene.solver.rate = 1 / (5 * 0.99 * longest);
  const auto simulation = must(Simulation::create(device(), scene));
  EXPECT_TRUE(simulation->fabric().notes.empty());
  EXPECT_NEAR(simulation->fabric().h, 0.99 * longest, 1e-9);
  run(*simulation, 6, 1 / scene.solver.rate);
  EXPECT_EQ(simulation->counts().non_finite, 0u);
  // It falls by less than 2 m.
  EXPECT_LT(top_speed(*simulation), std::sqrt(2 * 9.81 * 2));
  EXPECT_LT(strain_of(*simulation).max, 0.5);
}

// F6: the scarf at h = 0.004 s died within 100 steps.
TEST_F(MassSpring, a_longer_step_is_taken_in_parts_and_said_so) {
  const Scene scene = scarf(20, 0.004);
  const auto simulation = must(Simulation::create(device(), scene));
  EXPECT_NEAR(simulation->fabric().h, 0.002, 1e-9);
  ASSERT_EQ(simulation->fabric().notes.size(), 1u);
  EXPECT_NE(simulation->fabric().notes[0].find("a substep of 4 ms"), std::string::npos) << simulation->fabric().notes[0];
  run(*simulation, 4, 1 / scene.solver.rate);
  EXPECT_EQ(simulation->counts().non_finite, 0u);
  EXPECT_LT(strain_of(*simulation).max, 0.5);
}

TEST_F(MassSpring, springs_that_would_need_too_many_substeps_are_refused_with_the_number) {
  Scene scene = scarf(4, 0.003);
  scene.cloths[0].springs->structural.stiffness = 1e9;
  scene.cloths[0].springs->mass = 0.01;
  EXPECT_NE(refusal(scene).find("more than 1000"), std::string::npos) << refusal(scene);
  scene = scarf(4, 0.003);
  scene.cloths[0].springs.reset();
  scene.cloths[0].fabric.stretch = INFINITY;
  EXPECT_NE(refusal(scene).find("\"mass_spring\""), std::string::npos) << refusal(scene);
}

TEST_F(MassSpring, links_that_only_pull_let_a_sheet_fold_and_a_sphere_push_it) {
  Scene scene = scarf(10, 1 / 180.0);
  scene.solver.method = Method::verlet;
  scene.cloths[0].springs = Springs{.structural = {180, 0}, .shear = {180, 0}, .bend = {}, .mass = 0.02};
  scene.colliders = {sphere({0, 0, 0.3f}, 0.5)};
  const auto simulation = must(Simulation::create(device(), scene));
  EXPECT_TRUE(simulation->fabric().notes.empty());
  run(*simulation, 1, 1 / scene.solver.rate);
  EXPECT_EQ(simulation->counts().non_finite, 0u);
  for (const gpu::vec4& p : must(simulation->read_positions())) EXPECT_GT(std::hypot(p.x, p.y, p.z - 0.3f), 0.5);
}

TEST_F(MassSpring, momentum_is_kept_and_the_bits_are_the_same_twice) {
  Scene scene = scarf(10, 0.003);
  scene.cloths[0].anchors.clear();
  scene.gravity = {0, 0, 0};
  std::uint64_t hashes[2];
  for (std::uint64_t& hash : hashes) {
    const auto simulation = must(Simulation::create(device(), scene));
    auto pose = must(simulation->read_positions());
    for (gpu::vec4& p : pose) p = {p.x + 0.1f * p.x * p.x, p.y * (1.05f + 0.1f * p.x), 0.05f * p.x * p.y, p.w};
    must(simulation->write_positions(pose));
    const Point start = centre_of_mass(pose);
    run(*simulation, 1, 1 / scene.solver.rate);
    EXPECT_LT(distance(start, centre_of_mass(must(simulation->read_positions()))), 1e-5);
    hash = hash_of(*simulation);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace
}  // namespace weft
