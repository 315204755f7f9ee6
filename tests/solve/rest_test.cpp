// Cloth that rests is at rest: it neither creeps nor shivers.
//
// A speed is taken over a frame, as it is seen. The velocities of substeps also have the rounding of positions, a last bit in each
// substep: up to 1e-3 m/s some metres from the origin, which adds up to no motion.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using Rest = GpuTest;

constexpr double kAtRest = 1e-3;   // m/s

double seen_speed(Simulation& simulation) {
  const auto before = must(simulation.read_positions());
  must(simulation.advance(kFrame));
  const auto after = must(simulation.read_positions());
  double fastest = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    fastest = std::max(fastest, std::hypot(double(after[i].x) - before[i].x, double(after[i].y) - before[i].y,
                                           double(after[i].z) - before[i].z) / kFrame);
  return fastest;
}

double seen_speed_after(const compute::Device& device, const Scene& scene, double seconds) {
  const auto simulation = must(Simulation::create(device, scene));
  run(*simulation, seconds);
  double fastest = 0;
  for (int k = 0; k < 10; ++k) fastest = std::max(fastest, seen_speed(*simulation));
  EXPECT_EQ(simulation->counts().non_finite, 0u);
  return fastest;
}

// Cotton of the scene hung's ten metres. Its tethers have no slack, so that it hangs where it starts: with any it sags, folds and swings.
Scene hung() {
  Scene scene = sheet(32);
  scene.cloths[0].grid = Grid{{10, 10}, 32, 32, Topology::diagonal, true};
  scene.cloths[0].fabric = Fabric{};
  scene.cloths[0].tether_slack = 0;
  scene.cloths[0].anchors.push_back(held_at({Corner::low_high, Corner::high_high}));
  return scene;
}

// Over a ball and on the floor around it.
Scene draped(std::uint32_t cells) {
  Scene scene = sheet(cells);
  scene.cloths[0].grid->size = {1.4f, 1.4f};
  scene.cloths[0].transform.translate = {0, 0.61f, 0};
  scene.cloths[0].fabric.friction = 0.6;
  scene.colliders = {plane(0, 0.6), sphere({0, 0.25f, 0}, 0.35)};
  return scene;
}

TEST_F(Rest, a_sheet_that_hangs_by_two_corners_is_at_rest_within_three_seconds) {
  for (const Method method : {Method::jacobi, Method::gauss_seidel}) {
    Scene scene = hung();
    scene.solver.method = method;
    EXPECT_LT(seen_speed_after(device(), scene, 2.8), kAtRest);
  }
}

// Its folds swing, exp(-damping t / 2): a third of a metre a second at first, and a millimetre after six.
TEST_F(Rest, a_sheet_that_sags_and_folds_between_two_corners_is_at_rest_within_eight_seconds) {
  Scene scene = hung();
  scene.cloths[0].grid = Grid{{1, 1}, 24, 24, Topology::diagonal, true};
  scene.cloths[0].tether_slack.reset();
  scene.cloths[0].fabric.damping = 2;
  EXPECT_LT(seen_speed_after(device(), scene, 7.8), kAtRest);
}

TEST_F(Rest, a_sheet_on_the_floor_is_at_rest_at_once) {
  for (const bool contacts : {false, true}) {
    Scene scene = sheet(24);
    scene.cloths[0].fabric = Fabric{};
    scene.cloths[0].transform.translate = {0, 0.02f, 0};
    scene.colliders = {plane(0, 0.6)};
    scene.contacts.enabled = contacts;
    EXPECT_LT(seen_speed_after(device(), scene, 1), 0.01 * kAtRest);
  }
}

// Nothing but damping takes energy out of folds that swing, half of it a second: exp(-2 t) here, so that what moved at 1 m/s a second after
// the start is at 5e-4 m/s after 4.8 s, if friction, colliders and contacts add nothing.
TEST_F(Rest, a_sheet_over_a_ball_is_at_rest_within_five_seconds) {
  for (const bool contacts : {false, true}) {
    Scene scene = draped(20);
    scene.cloths[0].fabric.damping = 4;
    scene.contacts.enabled = contacts;
    EXPECT_LT(seen_speed_after(device(), scene, 4.8), kAtRest) << (contacts ? "with" : "without") << " contacts";
  }
}

// Folds that touch, of the scene tablecloth, after seven seconds. What swings at 25 rad/s changes its step by four tenths of it from frame
// to frame; what flaps, by all of it. With coarse links that were slack where candidates were (level.glsl) 114 particles did, by up to
// 0.7 mm.
TEST_F(Rest, folds_of_a_tablecloth_swing_and_do_not_shiver) {
  const auto simulation = must(Simulation::create(device(), must(load_scene(WEFT_ASSETS "/scenes/tablecloth.json"))));
  run(*simulation, 7);
  std::vector<std::vector<gpu::vec4>> seen;
  for (int k = 0; k < 32; ++k) {
    seen.push_back(must(simulation->read_positions()));
    must(simulation->advance(kFrame));
  }
  int flapping = 0;
  for (std::size_t i = 0; i < seen[0].size(); ++i) {
    double steps = 0, changes = 0;   // m2
    for (std::size_t k = 2; k < seen.size(); ++k) {
      const reference::Vector step = vector(seen[k][i]) - vector(seen[k - 1][i]), before = vector(seen[k - 1][i]) - vector(seen[k - 2][i]);
      steps += step.squaredNorm();
      changes += (step - before).squaredNorm();
    }
    const double rms = std::sqrt(steps / double(seen.size() - 2));
    flapping += rms > 1e-4 && changes > 0.8 * 0.8 * steps ? 1 : 0;
  }
  RecordProperty("flapping", flapping);
  EXPECT_LT(flapping, 5);
}

// With next to no drag it goes on swinging for long, but slowly: shivering from substep to substep would be at pi / h = 1900 rad/s.
TEST_F(Rest, a_sheet_that_is_not_at_rest_swings_and_does_not_shiver) {
  for (const bool contacts : {false, true}) {
    Scene scene = draped(20);
    scene.cloths[0].fabric.damping = 0.1;
    scene.contacts.enabled = contacts;
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 2);
    double speeds = 0, changes = 0;
    auto before = must(simulation->read_velocities());
    for (int k = 0; k < 100; ++k) {
      must(simulation->advance(1.0 / 600));   // a substep
      const auto now = must(simulation->read_velocities());
      for (std::size_t i = 0; i < now.size(); ++i) {
        const double x = now[i].x - before[i].x, y = now[i].y - before[i].y, z = now[i].z - before[i].z;
        speeds += double(now[i].x) * now[i].x + double(now[i].y) * now[i].y + double(now[i].z) * now[i].z;
        changes += x * x + y * y + z * z;
      }
      before = now;
    }
    const double frequency = std::sqrt(changes / speeds) * 600;   // rad/s, the root of the mean square
    EXPECT_LT(frequency, 100) << (contacts ? "with" : "without") << " contacts";
    RecordProperty(contacts ? "rad_per_second_with_contacts" : "rad_per_second", std::to_string(frequency));
  }
}

}  // namespace
}  // namespace weft
