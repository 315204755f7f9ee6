// Which points anchors choose, and where keys take them.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "engine/cook/parts.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using Numbers = std::set<std::uint32_t>;

// 5 x 4 vertices over 1 m by 0.75 m in the xy plane, centred: vertex 5 j + i is at (i/4 - 0.5, j/4 - 0.375).
Cloth banner() {
  Cloth cloth;
  cloth.grid = Grid{{1, 0.75f}, 4, 3, Topology::diagonal, true};
  return cloth;
}

Result<Numbers> chosen(const Cloth& cloth) {
  const auto choices = cooking::choose_anchors(cloth, make_grid(*cloth.grid));
  if (!choices) return fail(choices.error());
  Numbers points;
  for (const auto& choice : *choices) points.insert(choice.point);
  return points;
}

Numbers chosen_by(const Anchor& anchor) {
  Cloth cloth = banner();
  cloth.anchors = {anchor};
  const auto points = chosen(cloth);
  EXPECT_TRUE(points) << points.error();
  return points ? *points : Numbers{};
}

TEST(Anchors, they_are_chosen_by_number) {
  Anchor anchor;
  anchor.vertices = {7, 3, 7};
  EXPECT_EQ(chosen_by(anchor), (Numbers{3, 7}));
}

TEST(Anchors, they_are_chosen_by_corner) {
  constexpr std::pair<Corner, std::uint32_t> kCorners[] = {
      {Corner::low_low, 0}, {Corner::high_low, 4}, {Corner::low_high, 15}, {Corner::high_high, 19}};
  for (const auto& [corner, vertex] : kCorners) {
    Anchor anchor;
    anchor.corners = {corner};
    EXPECT_EQ(chosen_by(anchor), Numbers{vertex});
  }
}

TEST(Anchors, they_are_chosen_by_their_distance_from_the_top) {
  Anchor anchor;
  anchor.top = 0;
  EXPECT_EQ(chosen_by(anchor), (Numbers{15, 16, 17, 18, 19}));
  anchor.top = 0.26;
  EXPECT_EQ(chosen_by(anchor).size(), 10u);
}

TEST(Anchors, they_are_chosen_by_box) {
  Anchor anchor;
  anchor.box = Anchor::Box{{-0.26f, -1, -1}, {0.01f, -0.1f, 1}};
  EXPECT_EQ(chosen_by(anchor), (Numbers{1, 2, 6, 7}));
}

TEST(Anchors, what_an_entry_chooses_is_united) {
  Anchor anchor;
  anchor.vertices = {19};
  anchor.corners = {Corner::low_low};
  anchor.box = Anchor::Box{{-1, -1, -1}, {-0.4f, -0.1f, 1}};
  EXPECT_EQ(chosen_by(anchor), (Numbers{0, 5, 19}));
}

TEST(Anchors, every_second_of_a_row_and_its_last_are_kept) {
  Anchor anchor;
  anchor.top = 0;
  anchor.every = 2;
  EXPECT_EQ(chosen_by(anchor), (Numbers{15, 17, 19}));
  anchor.every = 3;
  EXPECT_EQ(chosen_by(anchor), (Numbers{15, 18, 19}));
  anchor.every = 100;
  EXPECT_EQ(chosen_by(anchor), (Numbers{15, 19}));
}

TEST(Anchors, a_point_that_two_entries_choose_belongs_to_the_later) {
  Cloth cloth = banner();
  cloth.anchors.resize(2);
  cloth.anchors[0].top = 0;
  cloth.anchors[1].corners = {Corner::high_high};
  const auto choices = cooking::choose_anchors(cloth, make_grid(*cloth.grid));
  ASSERT_TRUE(choices) << choices.error();
  ASSERT_EQ(choices->size(), 5u);
  for (const auto& choice : *choices) EXPECT_EQ(choice.entry, choice.point == 19 ? 1u : 0u);
}

// A vertex on a UV seam names the point that it shares with its twin.
TEST(Anchors, both_vertices_of_a_seam_choose_its_point) {
  RenderMesh render;
  render.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  render.triangles = {{0, 1, 2}, {3, 4, 5}};
  render.uvs = {{0, 0}, {1, 0}, {0, 1}, {0, 0}, {1, 0}, {1, 1}};
  const auto mesh = weld_mesh(std::move(render));
  ASSERT_TRUE(mesh) << mesh.error();
  ASSERT_EQ(mesh->points.size(), 4u);
  Cloth cloth;
  cloth.anchors.resize(1);
  cloth.anchors[0].vertices = {1, 3};
  const auto choices = cooking::choose_anchors(cloth, *mesh);
  ASSERT_TRUE(choices) << choices.error();
  ASSERT_EQ(choices->size(), 1u);
  EXPECT_EQ((*choices)[0].point, mesh->point_of[3]);
}

TEST(Anchors, choosing_nothing_is_a_sentence) {
  Cloth cloth = banner();
  cloth.anchors.resize(2);
  cloth.anchors[0].top = 0;
  cloth.anchors[1].box = Anchor::Box{{5, 5, 5}, {6, 6, 6}};
  EXPECT_EQ(chosen(cloth).error(), "anchors[1]: it chooses none of the 20 points");
}

TEST(Anchors, a_vertex_that_is_not_there_is_a_sentence) {
  Cloth cloth = banner();
  cloth.anchors.resize(1);
  cloth.anchors[0].vertices = {20};
  EXPECT_EQ(chosen(cloth).error(), "anchors[0]: vertex 20 is not below the mesh's 20 vertices");
}

TEST(Anchors, corners_of_a_mesh_from_a_file_are_a_sentence) {
  Cloth cloth;
  cloth.anchors.resize(1);
  cloth.anchors[0].corners = {Corner::low_low};
  const auto choices = cooking::choose_anchors(cloth, make_grid(*banner().grid));
  ASSERT_FALSE(choices);
  EXPECT_NE(choices.error().find("corners belong to grids"), std::string::npos);
}

struct Moved {
  Scene scene = without_contacts();
  CookedFabric fabric;
  Vec3 at(std::uint32_t vertex, double time) const {
    const auto targets = anchor_targets(scene, fabric, time);
    for (std::size_t k = 0; k < targets.size(); ++k)
      if (fabric.anchors[k].vertex == vertex) return targets[k];
    ADD_FAILURE() << "vertex " << vertex << " is no anchor";
    return {};
  }
};

Key key(double time, Vec3 translate, double degrees) {
  Key k;
  k.time = time;
  k.translate = translate;
  k.axis = {0, 0, 1};
  k.degrees = degrees;
  return k;
}

Moved top_moved_by(std::vector<Key> keys) {
  Moved moved;
  moved.scene.cloths.push_back(banner());
  auto& anchors = moved.scene.cloths[0].anchors;
  anchors.resize(2);
  anchors[0].top = 0;
  anchors[0].keys = std::move(keys);
  anchors[1].corners = {Corner::low_low};
  const auto meshes = make_meshes(moved.scene);
  auto fabric = cook(moved.scene, *meshes);
  EXPECT_TRUE(fabric) << fabric.error();
  if (fabric) moved.fabric = std::move(*fabric);
  return moved;
}

void expect_near(Vec3 found, Vec3 expected) {
  constexpr float kRounding = 1e-6f;   // of coordinates below 1 m, in single precision
  EXPECT_NEAR(found.x, expected.x, kRounding);
  EXPECT_NEAR(found.y, expected.y, kRounding);
  EXPECT_NEAR(found.z, expected.z, kRounding);
}

TEST(AnchorTargets, they_follow_translations_and_hold_still_outside_their_keys) {
  const Moved moved = top_moved_by({key(1, {}, 0), key(3, {0, 0, 2}, 0)});
  expect_near(moved.at(15, 0), {-0.5f, 0.375f, 0});
  expect_near(moved.at(15, 2), {-0.5f, 0.375f, 1});
  expect_near(moved.at(15, 9), {-0.5f, 0.375f, 2});
}

TEST(AnchorTargets, they_turn_about_the_centre_of_their_entry) {
  const Moved moved = top_moved_by({key(0, {}, 0), key(1, {}, 90)});
  expect_near(moved.at(15, 1), {0, 0.375f - 0.5f, 0});
  expect_near(moved.at(17, 1), {0, 0.375f, 0});
  expect_near(moved.at(19, 1), {0, 0.375f + 0.5f, 0});
}

TEST(AnchorTargets, seven_hundred_and_twenty_degrees_turn_twice) {
  const Moved moved = top_moved_by({key(0, {}, 0), key(8, {}, 720)});
  expect_near(moved.at(19, 1), {0, 0.375f + 0.5f, 0});
  expect_near(moved.at(19, 2), {-0.5f, 0.375f, 0});
  expect_near(moved.at(19, 6), {-0.5f, 0.375f, 0});
  expect_near(moved.at(19, 8), {0.5f, 0.375f, 0});
}

TEST(AnchorTargets, an_entry_without_keys_stays_where_it_was_to_the_bit) {
  const Moved moved = top_moved_by({key(0, {}, 0), key(1, {1, 2, 3}, 77)});
  EXPECT_EQ(moved.at(0, 0.7), make_grid(*banner().grid).points[0]);
}

}  // namespace
}  // namespace weft
