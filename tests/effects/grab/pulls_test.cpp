// What cloth pulls hands by: momentum of cloth and hands together stays what it was, and a sheet that hangs weighs what it weighs.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/every_method.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using Pulls = GpuTest;
using Eigen::Vector3d;

Vector3d in_doubles(Vec3 v) { return {v.x, v.y, v.z}; }

struct Momentum {
  Vector3d linear = Vector3d::Zero(), angular = Vector3d::Zero();   // kg m/s; kg m^2/s about the origin
};
Momentum momentum_of(const Simulation& simulation) {
  Momentum sum;
  const auto x = must(simulation.read_positions()), v = must(simulation.read_velocities());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i].w == 0) continue;
    const Vector3d p = Vector3d(v[i].x, v[i].y, v[i].z) / x[i].w;
    sum.linear += p;
    sum.angular += Vector3d(x[i].x, x[i].y, x[i].z).cross(p);
  }
  return sum;
}

// Dragged to and fro by two hands, one of them too weak, with nothing else in the world.
Scene dragged() {
  Scene scene = sheet(12);
  scene.gravity = {};
  scene.grabs = 2;
  scene.reactions = true;
  scene.cloths[0].bending = false;
  return scene;
}

Vec3 way_at(int frame) { return {0.3f * std::sin(0.2f * static_cast<float>(frame)), 0.004f * static_cast<float>(frame), 0.1f}; }

TEST_F(Pulls, momentum_of_cloth_and_hands_is_balanced_in_all_ways) {
  for (const Method method : {Method::jacobi, Method::by_default, Method::gauss_seidel})
    for (const Way way : kWays) {
      SCOPED_TRACE(std::to_string(int(method)) + " way " + std::to_string(int(way)));
      Scene scene = dragged();
      scene.solver.method = method;
      const auto simulation = must(Simulation::create(device(), scene));
      const Grabbed strong = must(simulation->grab_near({0.4f, 0, 0.3f}, {.stiffness = 3000, .damping = 2, .force = 1000}));
      const Grabbed weak = must(simulation->grab_near({-0.5f, 0, 0}, {.stiffness = 1e5, .damping = 0, .force = 0.05}));
      Vector3d given = Vector3d::Zero();
      double most = 0;
      for (int frame = 0; frame < 41; ++frame) {
        if (frame < 40) {
          must(simulation->move_grab(strong.grab, strong.point + way_at(frame)));
        } else {   // what the last substep gave comes with the next
          must(simulation->let_go(strong.grab));
          must(simulation->let_go(weak.grab));
        }
        run_frame(device(), *simulation, way);
        (void)must(simulation->read_positions());   // waits
        const auto pulls = simulation->take_pulls();
        ASSERT_EQ(pulls.size(), 2u);
        for (const Reaction& pull : pulls) given += in_doubles(pull.impulse);
        most = std::max(most, momentum_of(*simulation).linear.norm());
      }
      EXPECT_GT(most, 0.05);
      EXPECT_LT((momentum_of(*simulation).linear + given).norm(), 1e-4 * most);
      for (const Reaction& pull : simulation->take_pulls()) EXPECT_EQ(pull.impulse, Vec3{}) << "it was told";
    }
}

// By its middle, at rest: its weight, and no torque that its corners do not balance.
TEST_F(Pulls, a_sheet_that_hangs_weighs_what_it_weighs) {
  Scene scene = dragged();
  scene.gravity = {0, -9.81f, 0};
  scene.cloths[0].bending = true;
  scene.cloths[0].fabric.damping = 6;
  const auto simulation = must(Simulation::create(device(), scene));
  (void)must(simulation->grab_near({0, 0, 0}, {.stiffness = 3000, .damping = 2, .force = 1000}));
  run(*simulation, 3);
  (void)simulation->take_pulls();
  run(*simulation, 1);
  EXPECT_NEAR(simulation->take_pulls()[0].impulse.y, -0.12 * 9.81, 0.01 * 0.12 * 9.81);
}

TEST_F(Pulls, are_the_same_from_a_snapshot) {
  const Scene scene = dragged();
  auto goes = must(Simulation::create(device(), scene));
  const Grabbed held = must(goes->grab_near({0.4f, 0, 0.3f}, {.stiffness = 3000, .damping = 2, .force = 1000}));
  const auto frame_at = [&](Simulation& simulation, int frame) {
    must(simulation.move_grab(held.grab, held.point + way_at(frame)));
    must(simulation.advance(kFrame));
  };
  for (int frame = 0; frame < 10; ++frame) frame_at(*goes, frame);
  auto other = resumed(device(), *goes, scene);
  (void)goes->take_pulls();
  for (int frame = 10; frame < 15; ++frame) frame_at(*goes, frame), frame_at(*other, frame);
  EXPECT_EQ(goes->take_pulls()[0].impulse, other->take_pulls()[0].impulse);
  EXPECT_EQ(hash_of(*goes), hash_of(*other));
}

TEST_F(Pulls, a_scene_that_does_not_ask_is_told_nothing) {
  Scene scene = dragged();
  scene.reactions = false;
  const auto simulation = must(Simulation::create(device(), scene));
  EXPECT_TRUE(simulation->take_pulls().empty());
}

}  // namespace
}  // namespace weft
