// Where cloths start that do not start at rest: what a scene's `start` does to the cooked particles, and that it does nothing else.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

Scene sheet(StartPose pose) {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{2, 1}, 16, 8, Topology::diagonal, false};
  cloth.transform.translate = {3, 1, 0};
  cloth.start.pose = pose;
  cloth.start.imperfection = 0;
  return scene;
}

double length_of(const CookedFabric& fabric, const StretchLink& link) {
  const gpu::vec4 &a = fabric.positions[link.a], &b = fabric.positions[link.b];
  return std::hypot(double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z);
}

TEST(Start, a_fold_bends_about_the_middle_and_stretches_nothing) {
  for (const double degrees : {90.0, 180.0, -90.0, 270.0}) {
    Scene scene = sheet(StartPose::folded);
    scene.cloths[0].start.degrees = degrees;
    const CookedFabric fabric = cooked(scene), rest = cooked(sheet(StartPose::rest));
    for (const StretchLink& link : fabric.links) {
      if (link.only_pulls || (rest.positions[link.a].x - 3) * (rest.positions[link.b].x - 3) < 0) continue;   // far links cross the fold
      EXPECT_NEAR(length_of(fabric, link), link.rest, 1e-5 * link.rest);
    }
    for (std::size_t i = 0; i < rest.positions.size(); ++i) {
      const double s = rest.positions[i].x - 3, half = degrees * M_PI / 360;
      EXPECT_NEAR(fabric.positions[i].x, 3 + s * std::cos(half), 1e-5);
      EXPECT_NEAR(fabric.positions[i].y, 1 + std::abs(s) * std::sin(half), 1e-5);
      EXPECT_EQ(fabric.positions[i].z, rest.positions[i].z);
    }
  }
}

// Two leaves that make an angle at rest, higher at their ends by half their length: tan 26.57 degrees.
TEST(Start, a_fold_turns_each_side_of_a_bent_mesh_as_it_is) {
  Scene scene = sheet(StartPose::folded);
  scene.cloths[0].start.degrees = 90;
  auto meshes = make_meshes(scene);
  ASSERT_TRUE(meshes);
  for (Vec3& p : meshes->front().points) p.y += 0.5f * std::abs(p.x - 3);
  const auto fabric = cook(scene, *meshes);
  ASSERT_TRUE(fabric) << fabric.error();
  for (const StretchLink& link : fabric->links)
    if (!link.only_pulls) { EXPECT_NEAR(length_of(*fabric, link), link.rest, 1e-5 * link.rest); }
  double highest = 0;
  for (const gpu::vec4& p : fabric->positions) highest = std::max(highest, double(p.y));
  EXPECT_NEAR(highest, 1 + std::sqrt(1.25) * std::sin(std::atan(0.5) + M_PI / 4), 1e-5);
}

TEST(Start, a_fold_round_an_arc_keeps_its_halves_two_radii_apart) {
  Scene scene = sheet(StartPose::folded);
  scene.cloths[0].start.radius = 0.1;
  const CookedFabric fabric = cooked(scene), rest = cooked(sheet(StartPose::rest));
  for (std::size_t i = 0; i < rest.positions.size(); ++i) {
    const double s = rest.positions[i].x - 3;
    if (std::abs(s) < 0.1 * M_PI / 2) continue;
    EXPECT_NEAR(fabric.positions[i].x, 3 + std::copysign(0.1, s), 1e-6);
    EXPECT_NEAR(fabric.positions[i].y, 1 + 0.1 + std::abs(s) - 0.1 * M_PI / 2, 1e-6);
  }
}

TEST(Start, a_stretched_sheet_is_as_it_was_at_one_end_and_30_percent_longer_at_the_other) {
  const CookedFabric fabric = cooked(sheet(StartPose::stretched)), rest = cooked(sheet(StartPose::rest));
  double left = 0, right = 0;
  for (const StretchLink& link : fabric.links) {
    if (link.only_pulls || rest.positions[link.a].z != rest.positions[link.b].z) continue;
    const double middle = (rest.positions[link.a].x + rest.positions[link.b].x) / 2 - 3, strain = length_of(fabric, link) / link.rest - 1;
    EXPECT_NEAR(strain, 0.3 * (middle + 1) / 2, 1e-4);
    left = std::min(left, middle);
    right = std::max(right, middle);
  }
  EXPECT_LT(left, -0.9);
  EXPECT_GT(right, 0.9);
}

TEST(Start, whatever_the_pose_anchors_masses_and_all_that_is_cooked_stay) {
  Scene at_rest = sheet(StartPose::rest);
  at_rest.cloths[0].anchors.emplace_back().corners = {Corner::low_low, Corner::high_low};
  const CookedFabric rest = cooked(at_rest);
  for (const StartPose pose : {StartPose::stretched, StartPose::folded, StartPose::flattened, StartPose::scrambled, StartPose::collapsed}) {
    Scene scene = at_rest;
    scene.cloths[0].start.pose = pose;
    scene.cloths[0].start.velocity = {1, 2, 3};
    const CookedFabric fabric = cooked(scene);
    ASSERT_EQ(fabric.links.size(), rest.links.size());
    for (std::size_t k = 0; k < rest.links.size(); ++k) EXPECT_EQ(fabric.links[k].rest, rest.links[k].rest);
    for (std::size_t i = 0; i < rest.positions.size(); ++i) {
      const gpu::vec4 &p = fabric.positions[i], &was = rest.positions[i], &v = fabric.velocities[i];
      EXPECT_EQ(p.w, was.w);
      EXPECT_LE(std::max({std::abs(p.x - 3), std::abs(p.y - 1), std::abs(p.z)}), 1.31);
      if (was.w == 0) EXPECT_TRUE(p.x == was.x && p.y == was.y && p.z == was.z && v.x == 0 && v.y == 0 && v.z == 0);
      else EXPECT_TRUE(v.x == 1 && v.y == 2 && v.z == 3);
      if (pose == StartPose::collapsed && was.w > 0) { EXPECT_TRUE(p.x == 3 && p.y == 1 && p.z == 0); }
      if (pose == StartPose::flattened && was.w > 0) { EXPECT_TRUE(p.x == 3 && p.z == was.z); }
    }
  }
}

// Across the cloth, at most the told part of its thickness, the same in every run; held vertices stay.
TEST(Start, cloth_begins_off_its_plane_by_a_part_of_its_thickness) {
  Scene scene = sheet(StartPose::rest);
  scene.cloths[0].anchors.emplace_back().corners = {Corner::low_low};
  const CookedFabric flat = cooked(scene);
  scene.cloths[0].start.imperfection = Start().imperfection;
  const CookedFabric fabric = cooked(scene), again = cooked(scene);
  const double most = Start().imperfection * scene.cloths[0].fabric.thickness;
  double sum = 0, squares = 0, farthest = 0;
  for (std::size_t i = 0; i < fabric.positions.size(); ++i) {
    const gpu::vec4 &p = fabric.positions[i], &q = flat.positions[i];
    EXPECT_TRUE(p.x == q.x && p.z == q.z && p.y == again.positions[i].y) << i;
    const double off = double(p.y) - q.y;
    if (p.w == 0) { EXPECT_EQ(off, 0); }
    sum += off, squares += off * off, farthest = std::max(farthest, std::abs(off));
  }
  const double n = static_cast<double>(fabric.positions.size());
  EXPECT_LT(farthest, most * (1 + 1e-2) + 1e-7);
  EXPECT_GT(farthest, 0.9 * most);
  EXPECT_LT(std::abs(sum / n), 0.2 * most);
  EXPECT_NEAR(std::sqrt(squares / n), most / std::sqrt(3), 0.1 * most) << "evenly distributed";
  for (const StretchLink& link : fabric.links) EXPECT_NEAR(length_of(fabric, link), link.rest, 2e-5 * link.rest);
}

// Where edges are short, a fiftieth of the thickness would be steep: nothing may show in the shading.
TEST(Start, what_is_at_random_is_drawn_by_its_seed) {
  for (const StartPose pose : {StartPose::rest, StartPose::scrambled}) {
    Scene scene = sheet(pose);
    scene.cloths[0].start.imperfection = 0.1;
    const auto drawn_by = [&](std::uint32_t seed) {
      scene.cloths[0].start.seed = seed;
      return cooked(scene).positions;
    };
    const auto first = drawn_by(0), again = drawn_by(0), last = drawn_by(4294967295u);
    std::size_t alike = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_EQ(first[i].y, again[i].y);
      alike += first[i].y == last[i].y;
    }
    EXPECT_LT(alike, first.size() / 4);
  }
}

TEST(Start, fine_cloth_begins_no_steeper_than_coarse) {
  Scene scene = sheet(StartPose::rest);
  scene.cloths[0].grid = Grid{{0.02f, 0.01f}, 40, 20, Topology::diagonal, false};   // edges of 0.5 mm
  scene.cloths[0].start.imperfection = 1;
  // A second cloth before it: each is looked at by itself.
  scene.cloths.insert(scene.cloths.begin(), sheet(StartPose::rest).cloths[0]);
  const CookedFabric fabric = cooked(scene);
  double farthest = 0;
  for (std::size_t i = fabric.cloths[1].first_particle; i < fabric.positions.size(); ++i)
    farthest = std::max(farthest, std::abs(double(fabric.positions[i].y) - 1));
  EXPECT_GT(farthest, 0.5e-3 * 0.005 * 0.8);
  EXPECT_LT(farthest, 0.71e-3 * 0.005 + 1e-7);
}

}  // namespace
}  // namespace weft
