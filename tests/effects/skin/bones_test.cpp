// Colliders that joints carry: they go where an animation or the host's pose takes the joint, beside the cloth's own skin, wherever the
// world's origin is.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/skins.h"
#include "tests/support/ways.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using Bones = GpuTest;

constexpr float kQuarter = std::numbers::pi_v<float> / 2;

// Turned about z through the origin, then moved.
Affine turned_by(float angle, Vec3 way) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}, way};
}

// A sheet held at two corners, whose two joints turn and lift in a second; a capsule goes with the one, a box with the other, a plane with
// none.
struct Limbs {
  Scene scene = without_contacts();
  std::vector<Mesh> meshes;
};

Limbs limbs(bool animated, Vec3 place = {}) {
  Limbs made;
  made.scene = sheet(8);
  Cloth& cloth = made.scene.cloths[0];
  cloth.name = "skirt";
  cloth.transform.translate = place;
  cloth.anchors.push_back(held_at({Corner::low_low, Corner::high_high}));
  cloth.skin.emplace().loops = false;
  Collider& capsule = made.scene.colliders.emplace_back();
  capsule.shape = ColliderShape::capsule;
  capsule.centre = place + Vec3{0.2f, -0.5f, 0};
  capsule.axis = {1, 0, 0};
  capsule.radius = 0.1;
  capsule.radius_end = 0.05;
  capsule.bone = Bone{.cloth = "skirt", .joint = "high"};
  Collider& box = made.scene.colliders.emplace_back();
  box.shape = ColliderShape::box;
  box.centre = place + Vec3{-0.3f, -0.6f, 0.1f};
  box.size = {0.1f, 0.2f, 0.3f};
  box.bone = Bone{.cloth = "skirt", .joint = ""};
  made.scene.colliders.push_back(plane(-2));
  made.meshes = must(make_meshes(made.scene));
  Skin skin = two_joints(made.meshes[0]);
  if (animated) {
    const auto linear = Skin::Interpolation::linear;
    const float half = std::sin(kQuarter / 2), cosine = std::cos(kQuarter / 2);
    skin.animations.push_back({"lift",
                               {{1, Skin::Moves::translation, linear, {0, 1}, {{0, 0.1f, 0, 0}, {0, 0.4f, 0, 0}}},
                                {1, Skin::Moves::rotation, linear, {0, 1}, {{0, 0, 0, 1}, {0, 0, half, cosine}}}}});
  }
  made.meshes[0].skin = skin;
  return made;
}

// m: how far a collider is from where the map takes it, its centre and a point a metre along its y axis.
double off(const Simulation& simulation, std::uint32_t k, const Affine& map) {
  const Collider& collider = simulation.scene().colliders[k];
  const ColliderPose& pose = simulation.colliders()[k];
  const Vec3 up = rotated(rest_rotation(collider), {0, 1, 0});
  return std::max(length(pose.centre - map * collider.centre), length(rotated(pose.rotation, {0, 1, 0}) - turned(map, up)));
}

TEST_F(Bones, a_collider_goes_with_the_joint_that_an_animation_moves) {
  for (const Way way : kWays) {
    const Limbs made = limbs(true);
    const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
    const auto at = [&](double seconds) {
      const auto t = static_cast<float>(std::min(seconds, 1.0));
      return turned_by(t * kQuarter, {0, 0.1f + 0.3f * t, 0});
    };
    EXPECT_LT(off(*simulation, 0, at(0)), 1e-6);
    for (int frame = 1; frame <= 70; ++frame) {
      run_frame(device(), *simulation, way);
      // Between keys the joint turns along the arc, evenly.
      ASSERT_LT(off(*simulation, 0, at(frame * kFrame)), 1e-5) << frame;
      ASSERT_LT(off(*simulation, 1, {}), 1e-6) << frame;
    }
    EXPECT_EQ(simulation->colliders()[2].centre, (Vec3{0, -2, 0}));
  }
}

TEST_F(Bones, one_pose_moves_skin_and_colliders_and_a_snapshot_goes_on_wherever_the_origin_is) {
  for (const Vec3 place : {Vec3{}, Vec3{1000, 0, -500}}) {
    const Limbs made = limbs(false, place);
    const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
    const auto pose_at_frame = [&](int frame) {
      const float t = static_cast<float>(frame) / 40;
      const Affine about = Affine{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, place} * turned_by(t, {0, t, 0}) * moved_by(-1.0f * place);
      return std::array{moved_by({-t, 0, 0}), about};
    };
    for (int frame = 1; frame <= 20; ++frame) {
      must(simulation->set_pose(0, pose_at_frame(frame)));
      must(simulation->advance(kFrame));
      const double tolerance = place == Vec3{} ? 1e-5 : 3e-4;   // of floats a kilometre away
      ASSERT_LT(off(*simulation, 0, pose_at_frame(frame)[1]), tolerance) << frame;
      ASSERT_LT(off(*simulation, 1, pose_at_frame(frame)[0]), tolerance) << frame;
    }
    const auto bytes = snapshot_bytes(must(simulation->save()));
    const auto other = must(Simulation::create(device(), made.scene, made.meshes));
    must(other->restore(must(parse_snapshot(bytes))));
    for (Simulation* each : {simulation.get(), other.get()}) {
      must(each->set_pose(0, pose_at_frame(21)));
      run(*each, 0.1);
    }
    EXPECT_EQ(hash_of(*simulation), hash_of(*other));
    EXPECT_EQ(simulation->colliders()[0], other->colliders()[0]);
  }
}

// Cloth that lies on it is taken along at its speed, and nothing else moves it.
TEST_F(Bones, a_joint_s_scale_leaves_the_size_and_a_frame_without_a_pose_holds_still) {
  const Limbs made = limbs(false);
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  const Affine scaled{{0, 2, 0}, {-0.5f, 0, 0}, {0, 0, 3}, {0.1f, 0, 0}};   // a quarter of a turn
  must(simulation->set_pose(0, std::array{Affine{}, scaled}));
  must(simulation->advance(kFrame));
  const ColliderPose there = simulation->colliders()[0];
  EXPECT_LT(length(there.centre - scaled * made.scene.colliders[0].centre), 1e-6f);
  EXPECT_LT(length(rotated(there.rotation, {0, 1, 0}) - Vec3{0, 1, 0}), 1e-6f) << "its axis was x";
  EXPECT_EQ(simulation->collider_sizes()[0], (ColliderSize{0.1, 0.05, 0.5, {1, 1, 1}}));
  must(simulation->advance(kFrame));
  EXPECT_EQ(simulation->colliders()[0], there);
}

TEST_F(Bones, what_cannot_be_is_refused) {
  const auto fault = [&](const Limbs& made) {
    const auto simulation = Simulation::create(device(), made.scene, made.meshes);
    return simulation ? std::string("no fault") : simulation.error();
  };
  Limbs made = limbs(false);
  made.scene.colliders[0].bone->joint = "knee";
  EXPECT_EQ(fault(made), "cloths[0]: skin: it has no joint \"knee\", which colliders[0].bone.joint asks for; its joints are: \"low\", \"high\"");
  made = limbs(false);
  made.scene.colliders[0].bone->cloth = "skrit";
  EXPECT_EQ(fault(made), "colliders[0].bone.cloth: there is no cloth \"skrit\" (did you mean \"skirt\"?)");
  made = limbs(false);
  made.scene.colliders[1].keys = {{0, {}, {0, 1, 0}, 0}};
  EXPECT_EQ(fault(made), "colliders[1].keys: move what a bone moves already: leave one of the two away");
  made = limbs(false);
  made.scene.cloths[0].skin.reset();
  EXPECT_NE(fault(made).find("colliders[0].bone.cloth: the cloth \"skirt\" has no skin"), std::string::npos) << fault(made);

  made = limbs(false);
  const auto simulation = must(Simulation::create(device(), made.scene, made.meshes));
  const auto refused = simulation->move_collider(1, {.centre = {0, 1, 0}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "collider 1 goes with a joint of the cloth \"skirt\": set_pose, or the animation, moves it");
  must(simulation->move_collider(2, {.centre = {0, -3, 0}}));
  must(simulation->place_collider(0, {.centre = {0, -5, 0}}));
  EXPECT_EQ(simulation->colliders()[0].centre, (Vec3{0, -5, 0}));
  must(simulation->advance(kFrame));
  EXPECT_LT(off(*simulation, 0, {}), 1e-6) << "its joint takes it back";
}

}  // namespace
}  // namespace weft
