// What shifts promise: cloth that rests strains by two thirds or less of what it did, and what gives way by itself as much as its fabric says.
#include <gtest/gtest.h>

#include "tests/support/sheets.h"
#include "tests/support/ways.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using ShiftCase = GpuTest;

Strain after(const compute::Device& device, Scene scene, double seconds, bool shifts) {
  scene.solver.shifts = shifts;
  const auto simulation = must(Simulation::create(device, scene));
  run(*simulation, seconds);
  EXPECT_EQ(simulation->counts().non_finite, 0u);
  return strain_of(*simulation);
}

Scene over_a_ball(bool contacts) {
  Scene scene = sheet(40);
  scene.contacts.enabled = contacts;
  scene.cloths[0].transform.translate = {0, 0.6f, 0};
  scene.colliders = {sphere({0, 0.25f, 0}, 0.25), plane(0)};
  scene.solver.shifts = true;
  return scene;
}

TEST_F(ShiftCase, cloth_that_lies_over_a_ball_strains_by_less_than_two_thirds) {
  for (const bool contacts : {false, true}) {
    const Scene scene = over_a_ball(contacts);
    const double with = after(device(), scene, 3, true).mean, without = after(device(), scene, 3, false).mean;
    EXPECT_LT(with, 0.67 * without) << (contacts ? "with contacts" : "");
    EXPECT_LT(with, 0.01);
  }
}

// With r at 6/s folds swung on, and by a millimetre; without a bound on what is at rest friction and shifts hunted each other.
TEST_F(ShiftCase, cloth_over_a_ball_comes_to_rest) {
  for (const bool contacts : {false, true}) {
    Scene scene = sheet(20);
    scene.cloths[0].grid->size = {1.4f, 1.4f};
    scene.cloths[0].transform.translate = {0, 0.61f, 0};
    scene.cloths[0].fabric.friction = 0.6;
    scene.cloths[0].fabric.damping = 4;
    scene.colliders = {plane(0, 0.6), sphere({0, 0.25f, 0}, 0.35)};
    scene.contacts.enabled = contacts;
    scene.solver.shifts = true;
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 5);
    EXPECT_LT(top_speed(*simulation), 0.002) << (contacts ? "with contacts" : "");
  }
}

// In so many substeps as nobody takes for a game, links carry what they have to.
TEST_F(ShiftCase, a_soft_strip_that_hangs_is_as_long_as_its_fabric_says) {
  Scene scene = sheet(40);
  Cloth& cloth = scene.cloths[0];
  cloth.grid = Grid{{0.25f, 1}, 8, 32, Topology::diagonal, true};
  cloth.fabric.stretch = cloth.fabric.shear = 30;
  cloth.fabric.damping = 4;
  cloth.tethers = false;
  cloth.anchors.emplace_back().top = 0;
  for (const Method method : {Method::gauss_seidel, Method::strands}) {
    scene.solver.method = method;
    scene.solver.levels = true;
    scene.solver.substeps = 0;
    const double with = after(device(), scene, 4, true).mean, without = after(device(), scene, 4, false).mean;
    scene.solver.substeps = 100;
    const double all = after(device(), scene, 4, false).mean;
    EXPECT_LT(std::abs(with - all), 0.4 * std::abs(without - all)) << with << " for " << all << ", without " << without;
  }
}

// Shifts are what a frame leaves to the next: part of a snapshot, and restored where a frame is taken back.
TEST_F(ShiftCase, in_every_way_and_from_a_snapshot_the_bits_are_the_same) {
  for (const bool contacts : {false, true}) {
    const Scene scene = over_a_ball(contacts);
    std::vector<std::uint64_t> hashes;
    for (const Way way : kWays) {
      const auto simulation = must(Simulation::create(device(), scene));
      for (int frame = 0; frame < 40; ++frame) run_frame(device(), *simulation, way);
      hashes.push_back(hash_of(*simulation));
    }
    auto simulation = must(Simulation::create(device(), scene));
    for (int frame = 0; frame < 40; ++frame) {
      if (frame == 25) simulation = resumed(device(), *simulation, scene);
      must(simulation->advance(kFrame));
    }
    hashes.push_back(hash_of(*simulation));
    for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
    Scene plain = scene;
    plain.solver.shifts = false;
    simulation = must(Simulation::create(device(), plain));
    for (int frame = 0; frame < 40; ++frame) must(simulation->advance(kFrame));
    EXPECT_NE(hash_of(*simulation), hashes[0]) << "shifts change nothing";
  }
}

// What is pinned and let go again has links with other gains, and the same shifts.
TEST_F(ShiftCase, pins_come_and_go) {
  for (const Method method : {Method::gauss_seidel, Method::strands}) {
    Scene scene = over_a_ball(false);
    scene.solver.method = method;
    scene.solver.levels = true;
    scene.pins = 2;
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 2);
    const double before = strain_of(*simulation).mean;
    const std::uint32_t vertices[] = {0, 40};
    must(simulation->pin(vertices));
    run(*simulation, 0.5);
    must(simulation->release(vertices));
    run(*simulation, 1.5);
    const Strain strain = strain_of(*simulation);
    EXPECT_LT(strain.mean, 1.5 * before + 0.001);
    EXPECT_LT(strain.max, 0.3);
  }
}

// A shift pulls both ends alike, and is forgotten where nothing pulls any more.
TEST_F(ShiftCase, a_sheet_that_was_stretched_and_let_go_stays_where_it_is) {
  double strains[2];
  for (const bool shifts : {false, true}) {
    Scene scene = sheet(20);
    scene.gravity = {0, 0, 0};
    scene.solver.method = Method::gauss_seidel;
    scene.solver.levels = true;
    scene.solver.shifts = shifts;
    const auto simulation = must(Simulation::create(device(), scene));
    auto positions = must(simulation->read_positions());
    const Point begin = centre_of_mass(positions);
    for (gpu::vec4& x : positions) x.x *= 1.1f;
    must(simulation->write_positions(positions));
    run(*simulation, 2);
    strains[shifts] = strain_of(*simulation).mean;
    EXPECT_LT(distance(begin, centre_of_mass(must(simulation->read_positions()))), 10 * rounding_drift(24, 441));
  }
  EXPECT_LT(strains[1], 1.2 * strains[0]);
}

}  // namespace
}  // namespace weft
