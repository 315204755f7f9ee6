// Inertia in moving frames, as a host sees it: with none, cloth hangs in its frame as if that stood still; with all, it is as without.
#include <gtest/gtest.h>

#include <numbers>

#include <Eigen/Geometry>

#include "tests/support/skins.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using InertiaCase = GpuTest;
using Eigen::Vector3d;

// A sheet that hangs from an edge which a skin of one joint carries, and starts at its full length below it.
Scene carried(const Inertia& inertia) {
  Scene scene = sheet(12);
  scene.cloths[0].grid->upright = true;
  scene.cloths[0].fabric.damping = 0;   // it is the world's
  scene.cloths[0].skin.emplace();
  scene.cloths[0].anchors.emplace_back().top = 0.001;
  scene.cloths[0].inertia = inertia;
  return scene;
}

MovingFrame frame_at(const Eigen::Affine3d& map) {
  const Eigen::Quaterniond q(map.linear());
  const Vector3d o = map.translation();
  return {{static_cast<float>(o.x()), static_cast<float>(o.y()), static_cast<float>(o.z())},
          {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()), static_cast<float>(q.w())}};
}

// Runs, jumps, stops and turns about the vertical, as gravity allows.
Eigen::Affine3d wild(double t) {
  const double angle = 3 * std::sin(4 * t);
  return Eigen::Translation3d(2 * std::sin(5 * t), 0.3 * std::abs(std::sin(9 * t)), t > 0.5 ? 4 * (t - 0.5) : 0) *
         Eigen::Affine3d(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
}

void drive(Simulation& simulation, const compute::Device& device, Way way, const Eigen::Affine3d& map) {
  const Affine joint = narrowed(map);
  must(simulation.set_pose(0, std::span(&joint, 1)));
  must(simulation.move_frame(0, frame_at(map)));
  run_frame(device, simulation, way);
}

// m: how far particles are off, in their frame, from those of a cloth that stands still.
double farthest(const Simulation& goes, const Simulation& stays, const Eigen::Affine3d& map) {
  const auto a = must(goes.read_positions()), b = must(stays.read_positions());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, (map.inverse() * Vector3d(a[i].x, a[i].y, a[i].z) - Vector3d(b[i].x, b[i].y, b[i].z)).norm());
  return most;
}

TEST_F(InertiaCase, with_none_cloth_hangs_as_if_its_frame_stood_still) {
  // m. What is left is of the chords along which a turning frame's anchors go within a frame: of its second order, and nothing damps it.
  for (const auto& [rate, bound] : {std::pair(60.0, 0.06), std::pair(240.0, 0.01)}) {
    const auto with = [&, rate = rate](const Inertia& inertia) {
      Scene scene = carried(inertia);
      scene.solver.rate = rate;
      scene.solver.substeps = static_cast<std::uint32_t>(600 / rate);
      return must(Simulation::create(device(), scene));
    };
    const auto goes = with({0, 0, 0, ""}), stays = with({0, 0, 0, ""}), felt = with({1, 1, 1, ""});
    must(goes->move_frame(0, frame_at(wild(0))));
    must(felt->move_frame(0, frame_at(wild(0))));
    double most = 0, most_felt = 0;
    for (int k = 1; k <= rate; ++k) {
      const Eigen::Affine3d map = wild(k / rate);
      const Affine joint = narrowed(map);
      for (Simulation* simulation : {goes.get(), felt.get()}) {
        must(simulation->set_pose(0, std::span(&joint, 1)));
        must(simulation->move_frame(0, frame_at(map)));
      }
      for (Simulation* simulation : {goes.get(), felt.get(), stays.get()}) must(simulation->advance(1 / rate));
      most = std::max(most, farthest(*goes, *stays, map));
      most_felt = std::max(most_felt, farthest(*felt, *stays, map));
    }
    EXPECT_LT(most, bound) << rate << " Hz";
    EXPECT_GT(most_felt, 0.5) << "else nothing was shown";
  }
}

// Along straight lines nothing is left of it but rounding.
TEST_F(InertiaCase, with_no_linear_part_no_acceleration_is_felt) {
  const Scene scene = carried({0, 1, 1, ""});
  const auto goes = must(Simulation::create(device(), scene)), stays = must(Simulation::create(device(), scene));
  for (int k = 0; k <= 60; ++k) {
    const Eigen::Affine3d map(Eigen::Translation3d(k == 0 ? 0 : std::sin(k * 0.3), 0, 0.02 * k));
    if (k == 0) must(goes->move_frame(0, frame_at(map)));
    else drive(*goes, device(), Way::advance, map), run(*stays, kFrame);
    EXPECT_LT(farthest(*goes, *stays, map), 1e-3) << k;
  }
}

TEST_F(InertiaCase, with_all_it_has_the_bits_that_it_has_without) {
  Scene plain = carried({});
  plain.cloths[0].inertia.reset();
  const auto without = must(Simulation::create(device(), plain)), with = must(Simulation::create(device(), carried({1, 1, 1, ""})));
  must(with->move_frame(0, frame_at(wild(0))));
  for (int k = 1; k <= 30; ++k) {
    drive(*with, device(), Way::advance, wild(k / 60.0));
    const Affine joint = narrowed(wild(k / 60.0));
    must(without->set_pose(0, std::span(&joint, 1)));
    run(*without, kFrame);
  }
  EXPECT_EQ(hash_of(*with), hash_of(*without));
}

// A strip on a turntable leans outwards by r w^2 / g, and not at all without its centrifugal part.
TEST_F(InertiaCase, the_centrifugal_part_is_what_makes_it_lean) {
  for (const double part : {0.0, 0.5, 1.0}) {
    Scene scene = carried({0, 0, part, ""});
    scene.cloths[0].grid = Grid{{0.05f, 0.4f}, 1, 8, Topology::diagonal, true};
    scene.cloths[0].transform.translate = {1, 0, 0};   // its width along the way, its normal across
    scene.cloths[0].transform.axis = {0, 1, 0};
    scene.cloths[0].transform.degrees = 90;
    scene.cloths[0].fabric.damping = 0.5;
    const double w = 2;   // rad/s
    const auto simulation = must(Simulation::create(device(), scene));
    must(simulation->move_frame(0, {}));
    double angle = 0;
    double lean = 0;
    int counted = 0;
    for (int k = 1; k <= 600; ++k) {
      angle += w * std::min(1.0, k / 120.0) / 60;
      const Eigen::Affine3d map(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
      drive(*simulation, device(), Way::advance, map);
      if (k <= 360) continue;
      double high = 0, low = 0, highest = -1, lowest = 1;
      for (const gpu::vec4& x : must(simulation->read_positions())) {
        const double r = (map.inverse() * Vector3d(x.x, x.y, x.z)).x();
        if (x.y > highest) highest = x.y, high = r;
        if (x.y < lowest) lowest = x.y, low = r;
      }
      lean += (low - high) / (highest - lowest);
      ++counted;
    }
    EXPECT_NEAR(lean / counted, part * w * w * 1.08 / 9.81, 0.08 * part * w * w / 9.81 + 0.02) << "part " << part;
  }
}

TEST_F(InertiaCase, has_the_same_bits_in_all_ways_and_from_a_snapshot) {
  std::vector<std::uint64_t> hashes;
  const Scene scene = carried({0.3, 0.2, 0.6, ""});
  for (const Way way : kWays)
    for (const bool resumes : {false, true}) {
      auto simulation = must(Simulation::create(device(), scene));
      must(simulation->move_frame(0, frame_at(wild(0))));
      for (int k = 1; k <= 24; ++k) {
        drive(*simulation, device(), way, wild(k / 60.0));
        if (resumes && k == 11) {
          must(simulation->move_frame(0, frame_at(wild(12 / 60.0))));
          simulation = resumed(device(), *simulation, scene);
        }
      }
      hashes.push_back(hash_of(*simulation));
    }
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

// Set elsewhere and turned, with its frame and its anchors: it goes on as if it had always been there; and again, the other way.
TEST_F(InertiaCase, a_teleport_leaves_no_trace) {
  for (const bool contacts : {false, true}) {
    Scene scene = carried({0.5, 0.5, 0.5, ""});
    scene.cloths[0].start.imperfection = 0;
    scene.contacts.enabled = contacts;
    scene.cloths.push_back(sheet(4).cloths[0]);   // another stays where it falls
    const auto goes = must(Simulation::create(device(), scene)), stays = must(Simulation::create(device(), scene));
    const Eigen::Affine3d jump = Eigen::Translation3d(3, 0.5, -2) * Eigen::Affine3d(Eigen::AngleAxisd(2, Vector3d::UnitY()));
    for (Simulation* simulation : {goes.get(), stays.get()}) must(simulation->move_frame(0, frame_at(wild(0))));
    for (int k = 1; k <= 21; ++k) {
      const Eigen::Affine3d map = wild(k / 60.0);
      drive(*stays, device(), Way::advance, map);
      drive(*goes, device(), Way::advance, k > 20 ? jump * map : map);
      if (k == 20) must(goes->teleport(0, frame_at(map), frame_at(jump * map)));
    }
    const auto a = must(goes->read_positions()), b = must(stays->read_positions());
    const ClothRange &own = goes->fabric().cloths[0], &other = goes->fabric().cloths[1];
    for (std::uint32_t i = own.first_particle; i < own.first_particle + own.particles; ++i)
      EXPECT_LT((jump.inverse() * Vector3d(a[i].x, a[i].y, a[i].z) - Vector3d(b[i].x, b[i].y, b[i].z)).norm(), 2e-4) << i;   // rounding, shaken
    for (std::uint32_t i = other.first_particle; i < other.first_particle + other.particles; ++i)
      EXPECT_LT(std::hypot(a[i].x - b[i].x, a[i].y - b[i].y, a[i].z - b[i].z), 1e-4f);
  }
}

// Vertices that the host has pinned where they were, without knowing where, go with their cloth, and those of another stay.
TEST_F(InertiaCase, a_teleport_takes_pins_along) {
  Scene scene = sheet(8);
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform.translate = {0, 0, 2};
  scene.pins = 2;
  const auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 0.2);
  const std::uint32_t pinned[] = {0, 81};   // the first vertex of each
  must(simulation->pin(pinned));
  run(*simulation, 0.1);
  const auto before = must(simulation->read_vertex_positions());
  must(simulation->teleport(0, {}, {{3, 1, 0}, {}}));
  run(*simulation, 0.3);
  const auto after = must(simulation->read_vertex_positions());
  EXPECT_LT(length(after[0] - before[0] - Vec3{3, 1, 0}), 1e-5f);
  EXPECT_LT(length(after[81] - before[81]), 1e-5f);
}

// What a joint carries is there with its cloth, and meets nothing on the way.
TEST_F(InertiaCase, a_teleport_takes_the_colliders_of_bones_along) {
  Scene scene = carried({});
  scene.cloths[0].name = "cape";
  Collider& arm = scene.colliders.emplace_back();
  arm.shape = ColliderShape::capsule;
  arm.radius = 0.05;
  arm.centre = {0, 0.3f, 0.3f};
  arm.bone = Bone{"cape", ""};
  const auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 0.1);
  const MovingFrame there{{4, 0, -1}, {}};
  must(simulation->teleport(0, {}, there));
  EXPECT_LT(length(simulation->colliders()[0].centre - arm.centre - there.place), 1e-5f);
  const Affine pose = moved_by(there.place);
  must(simulation->set_pose(0, std::span(&pose, 1)));
  run(*simulation, 0.1);
  EXPECT_LT(length(simulation->colliders()[0].centre - arm.centre - there.place), 1e-5f);
}

// A joint of the skin is the frame, without a word of the host's: the host moves only the skin.
TEST_F(InertiaCase, follows_a_joint) {
  Scene scene = carried({0, 0, 0, "root"});
  std::vector<Mesh> meshes = must(make_meshes(scene));
  meshes[0].skin = two_joints(meshes[0]);
  meshes[0].skin->joints[0].name = "root";
  for (auto& weights : meshes[0].skin->weights) weights = {1, 0, 0, 0};
  for (auto& joints : meshes[0].skin->joints_of) joints = {0, 0, 0, 0};
  const auto goes = must(Simulation::create(device(), scene, meshes)), stays = must(Simulation::create(device(), scene, meshes));
  const auto pose = [](const Affine& joint) { return std::array{joint, Affine{}}; };
  double most = 0;
  for (int k = 0; k <= 40; ++k) {
    const Eigen::Affine3d map(Eigen::Translation3d(2 * std::sin(0.2 * k), 0, 0));
    must(goes->set_pose(0, pose(narrowed(map))));
    must(stays->set_pose(0, pose({})));
    run(*goes, kFrame);
    run(*stays, kFrame);
    most = std::max(most, farthest(*goes, *stays, map));
  }
  EXPECT_LT(most, 2e-3);
}

TEST_F(InertiaCase, what_is_wrong_is_a_sentence_and_changes_nothing) {
  const auto simulation = must(Simulation::create(device(), carried({})));
  EXPECT_EQ(simulation->move_frame(1, {}).error(),
            "cloth 1 has no frame to go with: there is none, or the scene does not ask for one (its key \"inertia\")");
  EXPECT_TRUE(simulation->move_frame(0, {{NAN, 0, 0}, {}}).error().starts_with("the frame of cloth 0: its place is not finite"));
  EXPECT_EQ(simulation->move_frame(0, {{}, {0, 0, 0, 0}}).error(), "the frame of cloth 0: its rotation has no length, or is not finite");
  EXPECT_EQ(simulation->teleport(3, {}, {}).error(), "there is no cloth 3, the scene has 1");
  EXPECT_FALSE(simulation->teleport(0, {}, {{1e11f, 0, 0}, {}}));
  const auto without = Simulation::create(device(), carried({0, 0, 0, "Hips"}));
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error(), "cloths[0]: inertia.joint: the mesh has no skin, and so no joint \"Hips\"");
}

}  // namespace
}  // namespace weft
