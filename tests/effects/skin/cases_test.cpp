// Skins in a simulation: anchors and mesh colliders go where they take them, wherever the world's origin is; a scene begins where its animation
// does; what cannot be is refused.
#include <gtest/gtest.h>

#include "compute/commands.h"
#include "engine/effects/skin/skin.h"
#include "tests/support/sheets.h"
#include "tests/support/skins.h"

namespace weft {
namespace {

using SkinCase = GpuTest;

// A sheet held at two corners, and below it a plate that is a mesh collider; each with two joints, and an animation that lifts the second.
struct Puppet {
  Scene scene;
  std::vector<Mesh> meshes;
};

Skin lifted(const Mesh& mesh, float height) {
  Skin skin = two_joints(mesh);
  const auto translate = Skin::Moves::translation;
  skin.animations.push_back({"lift", {{1, translate, Skin::Interpolation::linear, {0, 1}, {{0, 0.1f, 0, 0}, {0, 0.1f + height, 0, 0}}}}});
  return skin;
}

Puppet puppet(bool animated, Vec3 place = {}) {
  Puppet made;
  made.scene = sheet(12);
  made.scene.cloths[0].transform.translate = place;
  made.scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_high}));
  made.scene.cloths[0].skin.emplace();
  made.meshes = must(make_meshes(made.scene));
  made.scene.contacts.enabled = true;
  Collider& plate = made.scene.colliders.emplace_back();
  plate.shape = ColliderShape::mesh;
  plate.centre = place + Vec3{0, -0.4f, 0};
  plate.skin.emplace();
  made.meshes.push_back(make_grid({{1.4f, 1.4f}, 4, 4, Topology::diagonal, false}));
  for (Mesh& mesh : made.meshes) {
    mesh.skin = animated ? lifted(mesh, 0.3f) : two_joints(mesh);
    if (animated) made.scene.cloths[0].skin->loops = plate.skin->loops = false;
  }
  return made;
}

// m: how far what the skins move is from where joints (of all skins, the collider's in its own axes) take it.
double off(const Simulation& simulation, std::vector<Affine> joints) {
  const auto& lists = simulation.fabric().own.of<SkinLists>();
  for (const SkinnedMesh& skinned : lists.meshes)
    if (skinned.is_collider)
      for (std::uint32_t k = 0; k < skinned.joints; ++k) {
        const ColliderPose& pose = simulation.colliders()[skinned.index];
        joints[skinned.first_joint + k] = affine(pose.centre - simulation.origin(), pose.rotation) * joints[skinned.first_joint + k];
      }
  double most = 0;
  const auto positions = must(simulation.read_positions());
  for (const gpu::SkinPoint& point : lists.points) {
    const gpu::vec4& x = positions[point.particle];
    if (x.w == 0) most = std::max(most, double(length(skinned_point(point, joints) - Vec3{x.x, x.y, x.z})));
  }
  return most;
}

TEST_F(SkinCase, anchors_and_mesh_colliders_go_where_the_host_s_pose_takes_them) {
  for (const Vec3 place : {Vec3{}, Vec3{1000, 0, -500}}) {
    const Puppet made = puppet(false, place);
    const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
    EXPECT_LT(off(*simulation, std::vector<Affine>(4)), 1e-6);
    for (int frame = 1; frame <= 30; ++frame) {
      const float way = 0.005f * static_cast<float>(frame);
      const std::array cloth{moved_by({0, way, 0}), moved_by({-way, 0, way})}, body{moved_by({0, way, 0}), Affine{}};
      must(simulation->set_pose(0, cloth));
      must(simulation->set_body_pose(0, body));
      must(simulation->advance(kFrame));
      EXPECT_LT(off(*simulation, {cloth[0], cloth[1], body[0], body[1]}), 1e-6) << frame;
    }
    must(simulation->advance(kFrame));   // a frame without a pose holds still
    EXPECT_LT(off(*simulation, {moved_by({0, 0.15f, 0}), moved_by({-0.15f, 0, 0.15f}), moved_by({0, 0.15f, 0}), {}}), 1e-6);
    must(simulation->place_collider(0, {.centre = place + Vec3{0, -1, 0}}));
    EXPECT_LT(off(*simulation, {moved_by({0, 0.15f, 0}), moved_by({-0.15f, 0, 0.15f}), moved_by({0, 0.15f, 0}), {}}), 1e-6);
    EXPECT_EQ(simulation->counts().non_finite, 0u);
  }
}

// It begins where the animation does, goes where it goes, and stays where it ends; and the host may take over.
TEST_F(SkinCase, an_animation_moves_a_cloth_and_a_body) {
  const Puppet made = puppet(true);
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  const auto at = [](double seconds) {
    const Affine lift = moved_by({0, static_cast<float>(0.1 + 0.3 * std::min(seconds, 1.0)), 0});
    return std::vector<Affine>{{}, lift, {}, lift};
  };
  EXPECT_LT(off(*simulation, at(0)), 1e-6);
  for (int frame = 1; frame <= 80; ++frame) {
    must(simulation->advance(kFrame));
    EXPECT_LT(off(*simulation, at(frame / 60.0)), 1e-6) << frame;
  }
  const std::array down{Affine{}, moved_by({0, 0.2f, 0})};
  must(simulation->set_pose(0, down));
  run(*simulation, 0.1);
  EXPECT_LT(off(*simulation, {{}, down[1], {}, moved_by({0, 0.4f, 0})}), 1e-6);
}

TEST_F(SkinCase, what_the_host_cannot_mean_is_refused) {
  const Puppet made = puppet(false);
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  const auto fault = [](const Result<void>& result) { return result ? std::string() : result.error(); };
  std::vector<Affine> joints(3);
  EXPECT_EQ(fault(simulation->set_pose(0, joints)), "the pose of cloth 0 has 3 joints, and its skin 2");
  joints.resize(2);
  joints[1].y.z = NAN;
  EXPECT_EQ(fault(simulation->set_pose(0, joints)), "joint 1 of the pose of cloth 0 is not finite, or moves by 1e+10 m or more");
  EXPECT_NE(fault(simulation->set_pose(1, joints)).find("cloth 1 has no skin"), std::string::npos);
  EXPECT_NE(fault(simulation->set_body_pose(1, joints)).find("collider 1 has no skin"), std::string::npos);
  must(simulation->advance(kFrame));
  EXPECT_LT(off(*simulation, std::vector<Affine>(4)), 1e-6);

  Puppet wrong = puppet(true);
  wrong.scene.cloths[0].skin->animation = "run";
  const auto refused = Simulation::create(device(), wrong.scene, wrong.meshes);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "cloths[0]: skin.animation: the mesh has no \"run\"; its animations are: \"lift\"");
  wrong = puppet(true);
  wrong.scene.cloths[0].motion_constraints.emplace().max_distance_map = "COLOR_0.r";
  const auto without = Simulation::create(device(), wrong.scene, wrong.meshes);
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error(), "cloths[0]: motion_constraints.max_distance_map: the mesh has no attribute \"COLOR_0\"; it has none");
}

// A map says how far each vertex may go.
TEST_F(SkinCase, a_map_of_max_distances_is_kept_to) {
  Puppet made = puppet(false);
  made.scene.colliders.clear();
  made.meshes.resize(1);
  made.scene.cloths[0].anchors.clear();
  made.scene.cloths[0].motion_constraints = MotionConstraints{.max_distance = 0.2, .max_distance_map = "_REACH"};
  for (const Vec3& p : made.meshes[0].points) made.meshes[0].attributes["_REACH"].push_back({p.x + 0.5f, 0, 0, 0});
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  run(*simulation, 1);
  const auto positions = must(simulation->read_positions());
  double lowest = 0;
  for (const gpu::SkinPoint& point : simulation->fabric().own.of<SkinLists>().points) {
    const gpu::vec4& x = positions[point.particle];
    const double reach = 0.2 * (double(point.rest.x) + 0.5);
    EXPECT_LE(double(length(Vec3{x.x - point.rest.x, x.y - point.rest.y, x.z - point.rest.z})), 1.001 * reach + 1e-6);
    lowest = std::min(lowest, double(x.y));
  }
  EXPECT_LT(lowest, -0.1);
}

}  // namespace
}  // namespace weft
