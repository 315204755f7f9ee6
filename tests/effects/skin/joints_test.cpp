// Animations of joints, and skins that cannot be.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/must.h"
#include "tests/support/skins.h"

namespace weft {
namespace {

Mesh grid() { return make_grid({{1, 1}, 2, 2, Topology::diagonal, false}); }

Skin::Channel channel(Skin::Moves moves, Skin::Interpolation between, std::vector<float> times, std::vector<Vec4> values) {
  return {0, moves, between, std::move(times), std::move(values)};
}

Skin moving(Skin::Channel channel) {
  Skin skin = two_joints(grid());
  skin.animations.push_back({"it", {std::move(channel)}});
  return skin;
}

TEST(Joints, stay_or_go_straight_or_along_a_cubic_between_their_times) {
  const std::vector<float> times{1, 3};
  const Skin step = moving(channel(Skin::Moves::translation, Skin::Interpolation::step, times, {{0, 0, 0, 0}, {4, 0, 0, 0}}));
  const Skin linear = moving(channel(Skin::Moves::translation, Skin::Interpolation::linear, times, {{0, 0, 0, 0}, {4, 0, 0, 0}}));
  // With the tangents of t^2 - 2t + 1 the spline is that parabola.
  const Skin cubic = moving(channel(Skin::Moves::translation, Skin::Interpolation::cubic, times,
                                    {{9, 9, 9, 9}, {0, 0, 0, 0}, {0, 0, 0, 0}, {4, 0, 0, 0}, {4, 0, 0, 0}, {9, 9, 9, 9}}));
  for (const double time : {0.0, 1.0, 1.5, 2.0, 2.9, 3.0, 7.0}) {
    const double within = std::clamp(time, 1.0, 3.0);
    EXPECT_NEAR(joints_at(step, 0, time)[0].origin.x, time < 3 ? 0 : 4, 1e-6) << time;
    EXPECT_NEAR(joints_at(linear, 0, time)[0].origin.x, 2 * (within - 1), 1e-6) << time;
    EXPECT_NEAR(joints_at(cubic, 0, time)[0].origin.x, (within - 1) * (within - 1), 1e-6) << time;
    EXPECT_EQ(joints_at(linear, 0, time)[1], Affine{}) << "no channel moves it";
  }
  EXPECT_EQ(duration_of(linear.animations[0]), 3);
}

TEST(Joints, turn_evenly_along_the_shorter_arc) {
  const float half = std::sqrt(0.5f);
  for (const float sign : {1.f, -1.f}) {   // of the same rotation
    const Skin skin = moving(channel(Skin::Moves::rotation, Skin::Interpolation::linear, {0, 1}, {{0, 0, 0, 1}, {0, 0, sign * half, sign * half}}));
    for (const double time : {0.25, 0.5, 1.0}) {
      const Vec3 x = turned(joints_at(skin, 0, time)[0], {1, 0, 0});
      EXPECT_NEAR(x.x, std::cos(time * 3.14159265 / 2), 1e-6) << time;
      EXPECT_NEAR(x.y, std::sin(time * 3.14159265 / 2), 1e-6) << time;
    }
  }
}

// A joint below another goes with it; the inverse bind matrix takes the mesh to the joint's axes; and where the mesh was put goes around all.
TEST(Joints, of_a_tree_go_with_their_parents) {
  Skin skin = two_joints(grid());
  skin.nodes[1] = {.parent = 0, .translation = {0, 1, 0}, .scale = {1, 1, 1}, .rotation = {}, .matrix = {}};
  skin.joints[1].inverse_bind = moved_by({0, -1, 0});
  const float half = std::sqrt(0.5f);
  skin.animations = {{"turn", {channel(Skin::Moves::rotation, Skin::Interpolation::step, {0}, {{0, 0, half, half}})}}};
  EXPECT_EQ(joints_at(skin, kNone, 0)[1], Affine{});
  const Vec3 x = joints_at(skin, 0, 0)[1] * Vec3{0, 2, 0};
  EXPECT_NEAR(x.x, -2, 1e-6);
  EXPECT_NEAR(x.y, 0, 1e-6);
  skin.place = moved_by({5, 0, 0});
  const Vec3 there = joints_at(skin, 0, 0)[1] * Vec3{5, 2, 0};
  EXPECT_NEAR(there.x, 3, 1e-6);
  EXPECT_NEAR(there.y, 0, 1e-6);
}

TEST(Joints, that_cannot_be_are_refused) {
  const auto fault = [](auto&& spoil) {
    Mesh mesh = grid();
    mesh.skin = two_joints(mesh);
    mesh.skin->animations.push_back({"it", {channel(Skin::Moves::translation, Skin::Interpolation::linear, {0, 1}, {{}, {}})}});
    EXPECT_TRUE(check(mesh));
    spoil(mesh);
    const auto good = check(mesh);
    return good ? std::string() : good.error();
  };
  EXPECT_EQ(fault([](Mesh& m) { m.skin->weights[3] = {0.5f, 0.4f, 0, 0}; }), "skin.weights[3]: their sum is 0.9, not 1");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->weights[3] = {1.5f, -0.5f, 0, 0}; }), "skin.weights[3]: -0.5 is less than 0, or not a number");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->weights[1][0] = NAN; }), "skin.weights[1]: nan is less than 0, or not a number");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->joints_of[2][1] = 2; }), "skin.joints_of[2]: joint 2 is not one of the 2");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->weights.pop_back(); }), "skin: has weights of 8 and joints of 9 points, and there are 9");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->joints.clear(); }), "skin.joints: 0 are not 1 to 65535");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->joints[1].node = 7; }), "skin.joints[1]: node 7 is not one of the 2");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->nodes[0].parent = 1; }), "skin.nodes[0]: its parent, 1, does not come before it");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->animations[0].channels[0].times.clear(); }), "skin.animations[0].channels[0]: has no times");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->animations[0].channels[0].times = {1, 1}; }),
            "skin.animations[0].channels[0]: time 1, 1 s, is not finite or not after the one before");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->animations[0].channels[0].interpolation = Skin::Interpolation::cubic; }),
            "skin.animations[0].channels[0]: has 2 values, and its times need 6");
  EXPECT_EQ(fault([](Mesh& m) { m.skin->animations[0].channels[0].values[0].y = INFINITY; }),
            "skin.animations[0].channels[0]: has a value that is not finite");
  EXPECT_EQ(fault([](Mesh& m) { m.attributes["_W"] = {{}}; }), "attributes[\"_W\"] has 1 entries, and points has 9");
}

}  // namespace
}  // namespace weft
