// What motion constraints promise: nobody is farther from the animated place than the max distance, however fast that moves; no speed
// gathers at a backstop; a frame without a new pose holds still.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "compute/commands.h"
#include "engine/effects/skin/skin.h"
#include "tests/support/sheets.h"
#include "tests/support/skins.h"

namespace weft {
namespace {

using MotionConstraintCase = GpuTest;

Scene kept(double max_distance) {
  Scene scene = sheet(16);
  scene.cloths[0].motion_constraints = MotionConstraints{.max_distance = max_distance};
  return scene;
}

// m: how far particles are from where the pose of the only joint takes them, at most.
double farthest(const Simulation& simulation, const Affine& pose) {
  const Eigen::Affine3d map = widened(pose);
  double most = 0;
  const auto positions = must(simulation.read_positions());
  const Vec3 o = simulation.origin();
  for (const gpu::SkinPoint& point : simulation.fabric().own.of<SkinLists>().points) {
    const gpu::vec4& x = positions[point.particle];
    const Eigen::Vector3d rest(point.rest.x + o.x, point.rest.y + o.y, point.rest.z + o.z);
    most = std::max(most, (Eigen::Vector3d(x.x + o.x, x.y + o.y, x.z + o.z) - map * rest).norm());
  }
  return most;
}

Affine turned_about_z(double angle, Vec3 way) {
  return narrowed(Eigen::Translation3d(way.x, way.y, way.z) * Eigen::Affine3d(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())));
}

// At a walk and at a run, turning at ten radians a second, shaken to and fro; at three rates; with contacts, too.
TEST_F(MotionConstraintCase, nobody_is_farther_than_the_max_distance) {
  for (const bool contacts : {false, true})
    for (const double rate : {30.0, 60.0, 240.0})
      for (const double distance : {0.0, 0.01, 0.2}) {
        SCOPED_TRACE(std::to_string(distance) + " m at " + std::to_string(rate) + (contacts ? " Hz, contacts" : " Hz"));
        Scene scene = kept(distance);
        scene.solver.rate = rate;
        scene.contacts.enabled = contacts;
        const auto simulation = must(Simulation::create(device(), scene));
        double lost = 0;
        for (int frame = 1; frame <= int(rate / 2); ++frame) {
          const double t = frame / rate;
          const Affine pose = turned_about_z(10 * t, {static_cast<float>(8 * t), static_cast<float>(0.3 * std::sin(40 * t)), 0});
          must(simulation->set_pose(0, std::span(&pose, 1)));
          must(simulation->advance(1 / rate));
          lost = std::max(lost, farthest(*simulation, pose) - distance);
        }
        // m; rounding 4 m from the origin. Contacts come first: a step that they stop short is made good in the next substep, in which the pose
        // goes on by up to 27 m/s. It is chance where cloth meets itself then: at 200 to 260 Hz up to 4 % of 0.2 m, at others nothing.
        const double stopped = contacts && distance > 0.1 && rate > 200 ? 27 / (10 * rate) : 0;
        EXPECT_LT(lost, std::max(stopped, (contacts ? 1e-2 : 1e-3) * distance) + 4e-6);
        EXPECT_EQ(simulation->counts().non_finite, 0u);
      }
}

// Held to their places they are as fast as these, in all substeps alike: the way is not made in the first one.
TEST_F(MotionConstraintCase, the_pose_moves_evenly_through_the_frame) {
  const auto simulation = must(Simulation::create(device(), kept(0)));
  for (int frame = 1; frame <= 4; ++frame) {
    const Affine pose = moved_by({0.05f * static_cast<float>(frame), 0, 0});   // 3 m/s
    must(simulation->set_pose(0, std::span(&pose, 1)));
    must(simulation->advance(kFrame));
    for (const gpu::vec4& v : must(simulation->read_velocities())) EXPECT_NEAR(v.x, 3, 0.01);
  }
  must(simulation->advance(kFrame));   // no new pose: it stays
  EXPECT_LT(farthest(*simulation, moved_by({0.2f, 0, 0})), 1e-6);
  EXPECT_LT(top_speed(*simulation), 1e-3);
}

// A sheet lies on its backstop for two seconds. When that is taken away it falls as if it had just been let go.
TEST_F(MotionConstraintCase, no_speed_gathers_at_a_backstop) {
  Scene scene = kept(10);
  scene.cloths[0].motion_constraints->backstop_distance = 0.02;
  scene.cloths[0].motion_constraints->backstop_radius = 50;   // as good as a plane
  const auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 2);
  EXPECT_LT(top_speed(*simulation), 0.02);
  double low = 1;
  for (const gpu::vec4& x : must(simulation->read_positions())) low = std::min(low, double(x.y));
  EXPECT_GT(low, -0.0201);
  const Affine down = moved_by({0, -5, 0});
  must(simulation->set_pose(0, std::span(&down, 1)));
  must(simulation->advance(kFrame));
  run(*simulation, 0.25);
  for (const gpu::vec4& v : must(simulation->read_velocities())) EXPECT_NEAR(v.y, -9.81 * (0.25 + kFrame), 0.05);
}

TEST_F(MotionConstraintCase, the_host_changes_scale_and_stiffness) {
  const auto simulation = must(Simulation::create(device(), kept(0.1)));
  run(*simulation, 0.5);
  EXPECT_NEAR(farthest(*simulation, {}), 0.1, 1e-5);
  must(simulation->limit_motion(0, 0.5, 1));
  must(simulation->advance(kFrame));
  EXPECT_LT(farthest(*simulation, {}), 0.05 + 1e-6);
  EXPECT_GT(farthest(*simulation, {}), 0.045);   // it was pulled in fast
  must(simulation->limit_motion(0, 0.5, 0));
  run(*simulation, 0.5);
  EXPECT_GT(farthest(*simulation, {}), 1);
  for (const auto& [cloth, scale, stiffness] : {std::tuple{1u, 1.0, 1.0}, {0u, -1.0, 1.0}, {0u, 1.0, 1.5}, {0u, double(NAN), 1.0}})
    EXPECT_FALSE(simulation->limit_motion(cloth, scale, stiffness)) << cloth << ' ' << scale << ' ' << stiffness;
}

TEST_F(MotionConstraintCase, every_method_keeps_to_them) {
  for (const Method method : {Method::jacobi, Method::strands, Method::gauss_seidel, Method::chebyshev, Method::mass_spring, Method::verlet}) {
    Scene scene = kept(0.05);
    scene.solver.method = method;
    if (method == Method::chebyshev) scene.solver.substeps = 2, scene.solver.iterations = 4;
    if (on_springs(method)) scene.cloths[0].fabric.stretch = scene.cloths[0].fabric.shear = 50;
    const auto simulation = must(Simulation::create(device(), scene));
    // Chebyshev's steps leave it hanging by up to 0.04 mm within the limit at times, so it is the most of half a second that counts.
    double most = 0;
    for (run(*simulation, 0.5); simulation->time() < 1; run(*simulation, 0.05)) most = std::max(most, farthest(*simulation, {}));
    EXPECT_NEAR(most, 0.05, 1e-5) << static_cast<int>(method);
  }
  Scene scene = kept(0.05);
  scene.solver.method = Method::implicit;
  const auto refused = check(scene);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("cloths[0].motion_constraints"), std::string::npos) << refused.error();
}

// Two sheets whose poses cross each other's way, in three ways and from a snapshot.
TEST_F(MotionConstraintCase, the_same_bits_in_every_way_and_from_a_snapshot) {
  const auto made = [&] {
    Scene scene = kept(0.1);
    scene.cloths[0].motion_constraints->backstop_radius = 0.3;
    scene.cloths.push_back(scene.cloths[0]);
    scene.cloths[1].transform.translate = {0.1f, 0.2f, 0};
    scene.cloths[1].anchors.push_back(held_at({Corner::low_low}));
    scene.contacts.enabled = true;
    return must(Simulation::create(device(), scene));
  };
  std::vector<std::uint64_t> hashes;
  for (int way = 0; way < 4; ++way) {
    auto simulation = made();
    for (int frame = 0; frame < 30; ++frame) {
      const Affine pose = turned_about_z(0.02 * frame, {0, -0.01f * static_cast<float>(frame), 0});
      if (frame % 3 != 1) must(simulation->set_pose(1, std::span(&pose, 1)));
      if (frame == 9) must(simulation->limit_motion(0, 2, 0.5));
      if (way == 3 && frame == 16) {
        const Snapshot snapshot = must(simulation->save());
        simulation = made();
        must(simulation->restore(must(parse_snapshot(snapshot_bytes(snapshot)))));
      }
      if (way == 1) must(simulation->submit(kFrame));
      else if (way == 2)
        must(compute::run_once(device(), "host", [&](VkCommandBuffer commands) { must(simulation->record(commands, kFrame)); }));
      else must(simulation->advance(kFrame));
    }
    hashes.push_back(hash_of(*simulation));
  }
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

}  // namespace
}  // namespace weft
