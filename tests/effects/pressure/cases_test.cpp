// What a gas promises: it moves and turns nothing as a whole, nothing blows up whatever it is asked, and its bits are the same every time.
#include <gtest/gtest.h>

#include "tests/effects/pressure/inside.h"

namespace weft {
namespace {

using PressureCase = GpuTest;

struct Motion {
  reference::Vector momentum = reference::Vector::Zero(), spin = momentum, centre = momentum;   // N s, N m s, m
};
Motion motion_of(const Simulation& simulation) {
  const auto x = must(simulation.read_positions()), v = must(simulation.read_velocities());
  Motion sum;
  double mass = 0;
  for (const gpu::vec4& p : x) mass += 1 / double(p.w), sum.centre += reference::Vector(p.x, p.y, p.z) / double(p.w);
  sum.centre /= mass;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const reference::Vector impulse = reference::Vector(v[i].x, v[i].y, v[i].z) / double(x[i].w);
    sum.momentum += impulse;
    sum.spin += (reference::Vector(x[i].x, x[i].y, x[i].z) - sum.centre).cross(impulse);
  }
  return sum;
}

// A ball that flies and turns; near the origin of the world and far off.
TEST_F(PressureCase, a_free_balloon_keeps_its_momentum_and_its_spin) {
  for (const float place : {0.f, 5000.f})
    for (const Method method : {Method::jacobi, Method::gauss_seidel, Method::mass_spring}) {
      SCOPED_TRACE(testing::Message() << place << " m off, method " << int(method));
      Scene scene = gas_scene({.rest_pressure = 50});
      scene.solver.method = method;
      scene.cloths[0].fabric.area_density = 0.3;
      scene.cloths[0].fabric.stretch = 500;
      scene.cloths[0].start.velocity = {1, 0.5f, 0};
      const auto simulation = must(Simulation::create(device(), scene, std::vector{ball(0.2, 3, {place, 0, 0})}));
      auto v = must(simulation->read_velocities());
      const auto x = must(simulation->read_positions());
      const Motion still = motion_of(*simulation);
      for (std::size_t i = 0; i < v.size(); ++i) {
        const float along_x = x[i].x - static_cast<float>(still.centre.x()), along_z = x[i].z - static_cast<float>(still.centre.z());
        v[i].x += 2 * along_z, v[i].z -= 2 * along_x;
      }
      must(simulation->write_velocities(v));
      const Motion before = motion_of(*simulation);
      run(*simulation, 1);
      const Motion after = motion_of(*simulation);
      // Far off the cloth is up to 8 m from the particles' origin: places are as coarse, with gas or without.
      EXPECT_LT((after.momentum - before.momentum).norm(), (place == 0 ? 2e-4 : 2e-3) * before.momentum.norm());
      EXPECT_LT((after.spin - before.spin).norm(), 0.02 * before.spin.norm());
    }
}

// Whatever its values: no thinner cloth, no higher pressure, no other rate, nor any start, makes more of a ball than its gas can fill.
TEST_F(PressureCase, nothing_blows_up) {
  struct Case {
    Gas gas;
    double density, amount;
  };
  const double tiny = 1e-9, huge = 1e3;
  const Case cases[] = {{{}, 0.12, 1},
                        {{.rest_pressure = 1e7}, 0.01, 1},
                        {{.rest_pressure = 0}, 0.01, 1000},
                        {{.rest_pressure = 1e7, .ambient = 1e7}, 0.01, 0},
                        {{.rest_pressure = 1e7, .ambient = 0}, 0.12, 1},
                        {{.rest_pressure = 0, .ambient = 0}, 0.12, 1},
                        {{.rest_pressure = 1000, .volume = tiny}, 0.01, 1},
                        {{.rest_pressure = 1000, .volume = huge}, 0.01, 1}};
  for (const Case& c : cases)
    for (const double rate : {30.0, 60.0, 240.0})
      for (const StartPose pose : {StartPose::rest, StartPose::collapsed, StartPose::scrambled, StartPose::flattened}) {
        if (rate > 30 && pose != StartPose::rest && !(rate == 240 && pose == StartPose::scrambled)) continue;
        SCOPED_TRACE(testing::Message() << c.gas.rest_pressure << " Pa over " << c.gas.ambient << ", volume " << c.gas.volume.value_or(0)
                                        << ", density " << c.density << ", amount " << c.amount << ", " << rate
                                        << " Hz, start " << int(pose));
        Scene scene = gas_scene(c.gas);
        scene.solver.rate = rate;
        scene.cloths[0].fabric.area_density = c.density;
        scene.cloths[0].start.pose = pose;
        const double radius = 0.1;
        const auto simulation = must(Simulation::create(device(), scene, std::vector{ball(radius, 2)}));
        const double rest = simulation->fabric().own.of<GasLists>().gases[0].volume;
        must(simulation->inflate(0, c.amount));
        run(*simulation, 0.5, 1 / rate);
        must(simulation->inflate(0, 1));
        run(*simulation, 0.25, 1 / rate);
        const double reach = reach_of(*simulation);
        EXPECT_EQ(simulation->counts().non_finite, 0u);
        ASSERT_LT(reach, INFINITY);
        if (c.gas.ambient == 0) continue;   // nothing but the links holds it
        const double most = std::max(1.0, c.amount) * (1 + c.gas.rest_pressure / c.gas.ambient) * std::max(rest, 4.2 * std::pow(radius, 3));
        EXPECT_LT(reach, 4 * std::cbrt(most));
      }
}

// Pushed flat between two plates, and let go.
TEST_F(PressureCase, a_balloon_that_is_crushed_comes_back) {
  for (const bool contacts : {false, true}) {
    SCOPED_TRACE(contacts);
    Scene scene = gas_scene({.rest_pressure = 100});
    scene.contacts.enabled = contacts;
    scene.cloths[0].fabric.damping = 1;
    Collider lid = plane(0.43f, 0.4);
    lid.normal = {0, -1, 0};
    lid.keys = lowered({{0, 0}, {0.5, 0.42f}, {0.7, 0.42f}, {1, 0}});
    scene.colliders = {plane(0), lid};
    const auto simulation = must(Simulation::create(device(), scene, std::vector{ball(0.2, 3, {0, 0.21f, 0})}));
    const double rest = volume_of(*simulation);
    run(*simulation, 0.6);
    EXPECT_LT(volume_of(*simulation), 0.5 * rest);
    EXPECT_LT(reach_of(*simulation), 0.8);
    run(*simulation, 2.4);
    EXPECT_EQ(simulation->counts().non_finite, 0u);
    EXPECT_NEAR(volume_of(*simulation), rest, 0.05 * rest);
    EXPECT_LT(reach_of(*simulation), 0.3);
  }
}

// Two balloons, a sheet without gas, contacts, and a host that inflates.
Scene busy() {
  Scene scene = gas_scene({.rest_pressure = 100});
  scene.gravity = {0, -9.81f, 0};
  scene.contacts.enabled = true;
  scene.cloths.resize(3, scene.cloths[0]);
  scene.cloths[1].pressure.reset();
  scene.cloths[2].pressure->volume = 0.002;
  scene.colliders = {plane(0)};
  return scene;
}
std::vector<Mesh> busy_meshes() { return {ball(0.1, 3, {0, 0.11f, 0}), ball(0.05, 1, {0.3f, 0.1f, 0}), ball(0.08, 2, {0.02f, 0.31f, 0})}; }

TEST_F(PressureCase, every_way_to_run_a_frame_and_a_snapshot_give_the_same_bits) {
  std::vector<std::uint64_t> hashes;
  for (const Way way : kWays) {
    const auto simulation = must(Simulation::create(device(), busy(), busy_meshes()));
    for (int frame = 0; frame < 20; ++frame) {
      if (frame == 5) must(simulation->inflate(2, 2.5));
      run_frame(device(), *simulation, way);
    }
    hashes.push_back(hash_of(*simulation));
  }
  const auto half = must(Simulation::create(device(), busy(), busy_meshes()));
  for (int frame = 0; frame < 9; ++frame) {
    if (frame == 5) must(half->inflate(2, 2.5));
    run_frame(device(), *half, Way::advance);
  }
  const auto bytes = snapshot_bytes(must(half->save()));
  const auto other = must(Simulation::create(device(), busy(), busy_meshes()));
  must(other->restore(must(parse_snapshot(bytes))));
  for (int frame = 9; frame < 20; ++frame) run_frame(device(), *other, Way::advance);
  hashes.push_back(hash_of(*other));
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);

  auto damaged = must(parse_snapshot(bytes));
  damaged.gas_amounts[2] = -1;
  const auto refused = other->restore(damaged);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("a cloth has -1 times the scene's amount of gas"), std::string::npos) << refused.error();
  damaged.gas_amounts.pop_back();
  EXPECT_FALSE(other->restore(damaged));
}

TEST_F(PressureCase, what_the_host_gives_is_refused_with_its_limits) {
  const auto simulation = must(Simulation::create(device(), busy(), busy_meshes()));
  for (const double amount : {-1.0, 1001.0, double(NAN), double(INFINITY)}) {
    const auto refused = simulation->inflate(0, amount);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().find("times the scene's amount of gas, not from 0 to 1000"), std::string::npos) << refused.error();
  }
  for (const std::uint32_t cloth : {1u, 3u}) {
    const auto refused = simulation->inflate(cloth, 1);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error(), "cloth " + std::to_string(cloth) + " holds no gas (its key \"pressure\")");
  }
}

// Two dispatches a substep, however many hold a gas.
TEST_F(PressureCase, many_balloons_take_two_dispatches_a_substep) {
  Scene scene = gas_scene();
  scene.cloths.resize(100, scene.cloths[0]);
  std::vector<Mesh> meshes;
  for (int k = 0; k < 100; ++k) meshes.push_back(ball(0.05, 1, {0.2f * float(k % 10), 0, 0.2f * float(k / 10)}));
  const auto simulation = must(Simulation::create(device(), scene, meshes));
  std::uint32_t dispatches = 0;
  for (const PassUse& use : simulation->passes())
    if (use.name.starts_with("pressure")) dispatches += use.dispatches_per_frame;
  EXPECT_EQ(dispatches, 2 * 10u);
  run(*simulation, 0.1);
  EXPECT_EQ(simulation->counts().non_finite, 0u);
}

}  // namespace
}  // namespace weft
