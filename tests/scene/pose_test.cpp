// The scene that a bare mesh gets, and poses between keys.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene.h"

using namespace weft;

TEST(DefaultScene, an_upright_mesh_hangs_by_its_top_above_a_floor_and_in_view) {
  const Scene scene = default_scene("models/cape.glb", {-1, 0, -0.5f}, {1, 2, 0.5f});
  EXPECT_EQ(scene.name, "cape");
  EXPECT_EQ(scene.folder, "models");
  EXPECT_EQ(scene.cloths.at(0).mesh, "cape.glb");
  EXPECT_EQ(scene.frames, 300u);
  EXPECT_NEAR(*scene.cloths[0].anchors.at(0).top, 0.04, 1e-6);
  EXPECT_LT(scene.colliders.at(0).centre.y, 0);
  // Every corner of the box is within half the field of view of the line of sight.
  const Camera& camera = scene.camera;
  const Vec3 ahead = camera.target - camera.eye;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 point{corner & 1 ? 1.0f : -1, corner & 2 ? 2.0f : scene.colliders[0].centre.y, corner & 4 ? 0.5f : -0.5f};
    const Vec3 to = point - camera.eye;
    EXPECT_LT(std::acos(dot(to, ahead) / (length(to) * length(ahead))), camera.fov_degrees / 2 * 3.15 / 180);
  }
}

TEST(DefaultScene, a_flat_mesh_hangs_by_one_edge) {
  const Scene scene = default_scene("sheet.glb", {-1, 0, -1}, {1, 0, 1});
  ASSERT_TRUE(scene.cloths.at(0).anchors.at(0).box);
  const Anchor::Box& box = *scene.cloths[0].anchors[0].box;
  EXPECT_LT(box.low.z, -1);
  EXPECT_LT(box.high.z, -0.9f);
  EXPECT_LT(scene.colliders.at(0).centre.y, -2);
}

TEST(DefaultScene, a_mesh_of_no_size_still_gives_finite_figures) {
  const Scene scene = default_scene("dot.obj", {1, 1, 1}, {1, 1, 1});
  EXPECT_TRUE(std::isfinite(length(scene.camera.eye)));
  EXPECT_GT(length(scene.camera.eye - scene.camera.target), 0);
}

TEST(Pose, no_keys_do_not_move) { EXPECT_EQ(pose_at({}, 3), (Key{3, {0, 0, 0}, {0, 1, 0}, 0})); }

TEST(Pose, it_holds_still_before_the_first_and_after_the_last_key) {
  const Key keys[] = {{1, {1, 0, 0}, {0, 1, 0}, 10}, {2, {2, 0, 0}, {0, 1, 0}, 20}};
  EXPECT_EQ(pose_at(keys, 0).translate, (Vec3{1, 0, 0}));
  EXPECT_EQ(pose_at(keys, 0).degrees, 10);
  EXPECT_EQ(pose_at(keys, 99).translate, (Vec3{2, 0, 0}));
  EXPECT_EQ(pose_at(keys, 99).degrees, 20);
  EXPECT_EQ(pose_at(keys, 2).degrees, 20);
}

TEST(Pose, places_and_angles_about_one_axis_are_halfway_at_half_time) {
  const Key keys[] = {{0, {0, 0, 0}, {0, 1, 0}, 0}, {2, {4, -2, 1}, {0, 1, 0}, 720}};
  const Key half = pose_at(keys, 1);
  EXPECT_EQ(half.translate, (Vec3{2, -1, 0.5f}));
  EXPECT_EQ(half.degrees, 360);
  EXPECT_EQ(half.axis, (Vec3{0, 1, 0}));
  EXPECT_EQ(pose_at(keys, 0.5).degrees, 180);
}

TEST(Pose, a_key_that_does_not_turn_takes_the_axis_of_the_other) {
  const Key keys[] = {{0, {}, {0, 1, 0}, 0}, {1, {}, {1, 0, 0}, 720}, {2, {}, {0, 1, 0}, 0}};
  EXPECT_EQ(pose_at(keys, 0.5).degrees, 360);
  EXPECT_EQ(pose_at(keys, 0.5).axis, (Vec3{1, 0, 0}));
  EXPECT_EQ(pose_at(keys, 1.5).degrees, 360);
  EXPECT_EQ(pose_at(keys, 1.5).axis, (Vec3{1, 0, 0}));
}

TEST(Pose, opposite_axes_turn_opposite_ways) {
  const Key keys[] = {{0, {}, {0, 0, 1}, 90}, {1, {}, {0, 0, -1}, 270}};
  EXPECT_NEAR(pose_at(keys, 0.5).degrees, -90, 1e-9);
}

TEST(Pose, different_axes_take_the_shortest_arc) {
  const Key keys[] = {{0, {}, {1, 0, 0}, 90}, {1, {}, {0, 1, 0}, 90}};
  // Halfway between quarter turns about x and about y lies a turn about (1, 1, 0): its quaternion is the normalised mean of
  // theirs, (1, 1/2, 1/2, 0) / sqrt(1.5), an angle of 2 acos(1 / sqrt(1.5)) = 70.53 degrees.
  const Key half = pose_at(keys, 0.5);
  EXPECT_NEAR(half.degrees, 70.5288, 1e-3);
  EXPECT_NEAR(half.axis.x, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(half.axis.y, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(half.axis.z, 0, 1e-6);
}

TEST(Rotation, takes_up_to_a_capsules_axis_and_turns_a_box_about_its_own) {
  Collider capsule;
  capsule.shape = ColliderShape::capsule;
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0.6f, 0, -0.8f}}) {
    capsule.axis = axis;
    EXPECT_LT(length(rotated(rest_rotation(capsule), {0, 1, 0}) - axis), 1e-6);
  }
  Collider box;
  box.shape = ColliderShape::box;
  box.axis = {0, 0, 1};
  box.degrees = 90;
  EXPECT_LT(length(rotated(rest_rotation(box), {1, 0, 0}) - Vec3{0, 1, 0}), 1e-6);
  EXPECT_LT(length(rotated(rotation_about({0, 1, 0}, 90) * rest_rotation(box), {0, 1, 0}) - Vec3{0, 0, 1}), 1e-6);
}
