// Welding and mending: what a sloppy mesh becomes, and what is said about it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "engine/mesh.h"

namespace weft {
namespace {

/// Two triangles of a unit square in the xy plane, sharing nothing: six vertices, four places.
RenderMesh torn_square() {
  RenderMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  return mesh;
}

bool said(const Mesh& mesh, const std::string& start) {
  return std::ranges::any_of(mesh.mended, [&](const std::string& sentence) { return sentence.starts_with(start); });
}

TEST(Weld, vertices_at_one_place_become_one_point_and_keep_their_uvs) {
  RenderMesh torn = torn_square();
  torn.uvs = {{0, 1}, {0.5f, 1}, {0.5f, 0}, {0.6f, 1}, {1, 0}, {0.6f, 0}};
  const Result<Mesh> mesh = weld_mesh(torn);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->points.size(), 4u);
  EXPECT_EQ(mesh->render.positions.size(), 6u);
  EXPECT_EQ(mesh->point_of, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(mesh->render.uvs, torn.uvs);
  EXPECT_EQ(mesh->edges.size(), 5u);
  EXPECT_TRUE(mesh->mended.empty());
  EXPECT_DOUBLE_EQ(mesh->weld_tolerance, 1e-6 * std::sqrt(2.0));
}

TEST(Weld, both_sides_of_a_seam_get_the_same_normal) {
  RenderMesh bent = torn_square();
  bent.positions[5].z = 1;
  const Result<Mesh> mesh = weld_mesh(bent);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->render.normals[0], mesh->render.normals[3]);
  EXPECT_EQ(mesh->render.normals[2], mesh->render.normals[4]);
  EXPECT_NE(mesh->render.normals[1], mesh->render.normals[5]);
}

TEST(Weld, the_tolerance_is_the_border_between_one_point_and_two) {
  for (const bool inside : {true, false}) {
    RenderMesh torn = torn_square();
    const double gap = 1e-6 * std::sqrt(2.0) * (inside ? 0.9 : 1.1);
    torn.positions[3].x = static_cast<float>(-gap);   // at the origin, where floats resolve the gap
    const Result<Mesh> mesh = weld_mesh(torn);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->points.size(), inside ? 4u : 5u);
  }
}

TEST(Weld, a_chain_of_close_vertices_is_one_point) {
  // Six fans meet in vertices that lie 0.7 tolerances apart: neighbours meet, the ends only through them.
  RenderMesh mesh;
  for (int k = 0; k < 6; ++k) {
    const double turn = k * std::numbers::pi / 3, next = (k + 1) * std::numbers::pi / 3;
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back({static_cast<float>(k * 2e-6), 0, 0});   // the diagonal is 2.65: the tolerance is 2.65e-6
    mesh.positions.push_back({static_cast<float>(std::cos(turn)), static_cast<float>(std::sin(turn)), 0});
    mesh.positions.push_back({static_cast<float>(std::cos(next)), static_cast<float>(std::sin(next)), 0});
    mesh.triangles.push_back({base, base + 1, base + 2});
  }
  const Result<Mesh> welded = weld_mesh(mesh);
  ASSERT_TRUE(welded);
  EXPECT_EQ(welded->points.size(), 7u);
  EXPECT_EQ(welded->points[0], mesh.positions[0]);
}

TEST(Weld, which_vertices_meet_is_what_comparing_all_pairs_finds) {
  // Vertices crowd around the origin so that about half have a neighbour within the tolerance; each has a triangle of its own with
  // two corners on a circle, so nothing is dropped and the sets can be compared both ways.
  std::mt19937 random(7);
  std::uniform_real_distribution<float> crowd(-15e-6f, 15e-6f);   // the tolerance is 2.8e-6 m
  RenderMesh mesh;
  constexpr std::uint32_t count = 500;
  for (std::uint32_t t = 0; t < count; ++t) {
    mesh.positions.push_back({crowd(random), crowd(random), crowd(random)});
    for (const double step : {0.2, 0.8}) {
      const double turn = 2 * std::numbers::pi * (t + step) / count;
      mesh.positions.push_back({static_cast<float>(std::cos(turn)), static_cast<float>(std::sin(turn)), 0});
    }
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const Result<Mesh> welded = weld_mesh(mesh);
  ASSERT_TRUE(welded);
  EXPECT_TRUE(welded->mended.empty());

  std::vector<std::size_t> set(mesh.positions.size());
  std::iota(set.begin(), set.end(), std::size_t{0});
  std::size_t joined = 0;
  for (std::size_t i = 0; i < set.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 a = mesh.positions[i], b = mesh.positions[j];
      const double apart = std::hypot(double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z);
      if (apart > welded->weld_tolerance || set[i] == set[j]) continue;
      const std::size_t from = set[i], to = set[j];
      std::ranges::replace(set, from, to);
      ++joined;
    }
  EXPECT_EQ(welded->points.size(), set.size() - joined);
  EXPECT_GT(joined, count / 10);
  EXPECT_LT(joined, count * 9 / 10);
  for (std::size_t i = 0; i < set.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) ASSERT_EQ(set[i] == set[j], welded->point_of[i] == welded->point_of[j]) << i << " and " << j;
}

TEST(Weld, one_vertex_far_away_does_not_take_forever) {
  // A damaged exponent: the tolerance becomes larger than the rest of the mesh, which then is one point.
  Grid grid;
  grid.cells_x = grid.cells_y = 300;
  RenderMesh mesh = make_grid(grid).render;
  mesh.positions.back().x = 1e9f;
  EXPECT_FALSE(weld_mesh(mesh));
}

TEST(Weld, crowds_that_do_not_quite_touch_stay_two_points_until_one_vertex_lies_between) {
  // A quarter of a million vertices each, all at different places: comparing all pairs would take minutes.
  constexpr std::uint32_t kCrowd = 250'000;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> spread(0, 5e-7f);   // the tolerance is 2.8e-6 m
  for (const bool between : {false, true}) {
    RenderMesh mesh;
    mesh.positions = {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {0.5f, 0, 0.2f}};
    mesh.triangles = {{0, 1, 2}};
    for (std::uint32_t k = 0; k < 2 * kCrowd; ++k) {
      mesh.positions.push_back({spread(random), spread(random), k < kCrowd ? -1.4157e-6f : 1.4157e-6f});   // 2.8314e-6 m apart
      if (k == 0 || k == kCrowd) mesh.triangles.push_back({k + 4, 3, 0});
      if (k % 2 == 1) mesh.triangles.push_back({k + 3, k + 4, 3});
    }
    if (between) mesh.positions[kCrowd / 2].z += 3e-9f;
    const Result<Mesh> welded = weld_mesh(mesh);
    ASSERT_TRUE(welded);
    EXPECT_NEAR(welded->weld_tolerance, 2.8284e-6, 1e-10);
    EXPECT_EQ(welded->points.size(), between ? 5u : 6u);
  }
}

TEST(Weld, triangles_without_area_are_dropped_and_counted) {
  RenderMesh mesh = torn_square();
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 2, 4});   // 2 and 4 are one place
  mesh.positions.push_back({0.5f, 0.5f, 0});
  mesh.triangles.push_back({0, 6, 2});   // three in a line
  const Result<Mesh> mended = weld_mesh(mesh);
  ASSERT_TRUE(mended);
  EXPECT_EQ(mended->triangles.size(), 2u);
  EXPECT_EQ(mended->points.size(), 4u);
  EXPECT_TRUE(said(*mended, "3 triangles had no area"));
  EXPECT_TRUE(said(*mended, "1 vertex belonged to no triangle"));
}

TEST(Weld, duplicate_triangles_are_dropped_whichever_way_they_run) {
  RenderMesh mesh = torn_square();
  mesh.triangles.push_back({1, 2, 0});
  mesh.triangles.push_back({5, 4, 3});
  const Result<Mesh> mended = weld_mesh(mesh);
  ASSERT_TRUE(mended);
  EXPECT_EQ(mended->render.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_TRUE(said(*mended, "2 triangles lay on the same three points"));
}

TEST(Weld, vertices_of_no_triangle_are_dropped_and_counted) {
  RenderMesh mesh = torn_square();
  mesh.positions.insert(mesh.positions.begin(), 2, Vec3{9, 9, 9});
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v += 2;
  const Result<Mesh> mended = weld_mesh(mesh);
  ASSERT_TRUE(mended);
  EXPECT_EQ(mended->render.positions, torn_square().positions);
  EXPECT_TRUE(said(*mended, "2 vertices belonged to no triangle"));
  EXPECT_DOUBLE_EQ(mended->weld_tolerance, 1e-6 * std::sqrt(2.0));   // they do not stretch the bounding box
}

TEST(Weld, the_majority_of_a_piece_decides_the_winding) {
  Grid grid;
  grid.cells_x = grid.cells_y = 6;
  const Mesh whole = make_grid(grid);
  RenderMesh mesh = whole.render;
  for (const std::size_t t : {0, 7, 31}) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const Result<Mesh> mended = weld_mesh(mesh);
  ASSERT_TRUE(mended);
  EXPECT_TRUE(said(*mended, "3 triangles were wound against"));
  EXPECT_EQ(mended->edges.size(), whole.edges.size());
  for (const Vec3& normal : mended->render.normals) EXPECT_NEAR(normal.y, 1, 1e-6);
}

TEST(Weld, pieces_that_do_not_touch_keep_their_own_winding) {
  RenderMesh mesh = torn_square();
  for (const Vec3 p : {Vec3{5, 0, 0}, Vec3{6, 0, 0}, Vec3{5, 1, 0}}) mesh.positions.push_back(p);
  mesh.triangles.push_back({6, 8, 7});
  const Result<Mesh> mended = weld_mesh(mesh);
  ASSERT_TRUE(mended);
  EXPECT_TRUE(mended->mended.empty());
  EXPECT_EQ(mended->render.triangles[2], (Triangle{6, 8, 7}));
}

TEST(Weld, a_moebius_strip_is_kept_and_said_to_be_one) {
  constexpr std::uint32_t count = 24;
  RenderMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i)
    for (const double side : {-0.3, 0.3}) {
      const double turn = 2 * std::numbers::pi * i / count, radius = 1 + side * std::cos(turn / 2);
      mesh.positions.push_back({static_cast<float>(radius * std::cos(turn)), static_cast<float>(radius * std::sin(turn)),
                                static_cast<float>(side * std::sin(turn / 2))});
    }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t a = 2 * i, b = a + 1, next = (2 * i + 2) % (2 * count), c = i + 1 == count ? 1 : next,
                        d = i + 1 == count ? 0 : next + 1;
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
  }
  const Result<Mesh> mended = weld_mesh(mesh);
  ASSERT_TRUE(mended);
  EXPECT_EQ(mended->triangles.size(), 2 * count);
  EXPECT_EQ(mended->edges.size(), 4 * count);
  EXPECT_TRUE(said(*mended, "1 connected piece cannot be oriented"));
  EXPECT_TRUE(said(*mended, "1 edge lies between"));
}

TEST(Weld, a_flap_sewn_on_keeps_its_triangles_and_is_counted) {
  RenderMesh mesh = torn_square();
  mesh.positions.push_back({0.5f, 0.5f, 1});
  mesh.triangles.push_back({0, 2, 6});
  const Result<Mesh> mended = weld_mesh(mesh);
  ASSERT_TRUE(mended);
  EXPECT_EQ(mended->triangles.size(), 3u);
  EXPECT_EQ(mended->edges.size(), 7u);
  EXPECT_TRUE(said(*mended, "1 edge lies between more than two"));
}

TEST(Weld, missing_uvs_are_projected_without_distortion) {
  RenderMesh wide = torn_square();
  for (Vec3& p : wide.positions) p.x *= 2;
  const Result<Mesh> mesh = weld_mesh(wide);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->render.uvs[0], (Vec2{0, 0.5f}));
  EXPECT_EQ(mesh->render.uvs[4], (Vec2{1, 0}));
}

TEST(Weld, tangents_follow_u_and_know_a_mirrored_picture) {
  for (const bool mirrored : {false, true}) {
    RenderMesh torn = torn_square();
    for (const Vec3& p : torn.positions) torn.uvs.push_back({mirrored ? -p.x : p.x, 1 - p.y});
    const Result<Mesh> mesh = weld_mesh(torn);
    ASSERT_TRUE(mesh);
    for (const Vec4& t : mesh->render.tangents) EXPECT_EQ(t, (Vec4{mirrored ? -1.f : 1.f, 0, 0, mirrored ? -1.f : 1.f}));
  }
}

TEST(Weld, tangents_without_a_usable_uv_are_still_unit_and_perpendicular) {
  RenderMesh torn = torn_square();
  torn.positions[5].z = 0.7f;
  torn.uvs.assign(6, Vec2{0.3f, 0.3f});
  const Result<Mesh> mesh = weld_mesh(torn);
  ASSERT_TRUE(mesh);
  for (std::size_t v = 0; v < 6; ++v) {
    const Vec4 t = mesh->render.tangents[v];
    EXPECT_NEAR(length({t.x, t.y, t.z}), 1, 1e-6);
    EXPECT_NEAR(dot({t.x, t.y, t.z}, mesh->render.normals[v]), 0, 1e-6);
    EXPECT_EQ(std::abs(t.w), 1);
  }
}

TEST(Weld, vertices_that_are_not_finite_are_refused_with_their_count_and_the_first) {
  RenderMesh mesh = torn_square();
  mesh.positions[4].y = std::numeric_limits<float>::quiet_NaN();
  mesh.positions[2].x = std::numeric_limits<float>::infinity();
  const Result<Mesh> refused = weld_mesh(mesh);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "2 of 6 vertices are not finite, the first is vertex 2");
}

TEST(Weld, what_cannot_be_a_mesh_is_refused_with_a_sentence) {
  RenderMesh mesh = torn_square();
  mesh.triangles[1][2] = 6;
  EXPECT_EQ(weld_mesh(mesh).error(), "1 of 2 triangles points past the last of 6 vertices, the first is triangle 1");
  mesh = torn_square();
  mesh.normals.resize(5);
  EXPECT_FALSE(weld_mesh(mesh));
  mesh = torn_square();
  mesh.positions.assign(6, Vec3{3, 3, 3});
  EXPECT_EQ(weld_mesh(mesh).error(), "all 2 triangles lie at one place; none has an area");
  mesh = torn_square();
  for (Vec3& p : mesh.positions) p.y = 0;
  EXPECT_EQ(weld_mesh(mesh).error(), "none of the 2 triangles has an area");
  EXPECT_EQ(weld_mesh({}).error(), "the mesh has no triangle");
}

}   // namespace
}   // namespace weft
