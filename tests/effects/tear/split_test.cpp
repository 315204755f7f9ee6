// Splitting points of a mesh, and cooking what is torn.
#include <gtest/gtest.h>

#include <random>

#include "engine/fabric.h"
#include "engine/snapshot.h"
#include "tests/effects/tear/torn.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

// The corners of the first fan of a point, from one to another.
Split split_of(const Mesh& mesh, std::uint32_t point, std::size_t from, std::size_t to) {
  const cooking::Fan fan = cooking::Fans(mesh).of(point).front();
  Split split{point, {fan.corners.begin() + static_cast<std::ptrdiff_t>(from), fan.corners.begin() + static_cast<std::ptrdiff_t>(to)}};
  std::ranges::sort(split.corners);
  return split;
}

TEST(Splits, make_two_points_of_one_and_keep_all_else) {
  Mesh mesh = tearable(4, 3);
  mesh.attributes["_WEAK"].assign(mesh.points.size(), {0, 0, 0, 1});
  mesh.attributes["_WEAK"][12].x = 0.5f;
  const Mesh whole = mesh;
  const std::vector<Split> splits = {split_of(mesh, 12, 0, 3)};
  ASSERT_EQ(must(split_points(mesh, splits)), 1u);
  EXPECT_TRUE(check(mesh)) << check(mesh).error();
  EXPECT_EQ(mesh.points.size(), whole.points.size() + 1);
  EXPECT_EQ(mesh.points.back(), whole.points[12]);
  EXPECT_EQ(mesh.attributes["_WEAK"].back().x, 0.5f);
  EXPECT_EQ(mesh.render.positions.size(), whole.render.positions.size());
  EXPECT_EQ(mesh.spare_points, 2u);
  EXPECT_EQ(mesh.spare_vertices, 2u);
  EXPECT_EQ(mesh.triangles.size(), whole.triangles.size());
  EXPECT_DOUBLE_EQ(area_of(mesh), area_of(whole));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const bool moved = std::ranges::binary_search(splits[0].corners, 3 * t + k);
      EXPECT_EQ(mesh.triangles[t][k], moved ? 25u : whole.triangles[t][k]);
      const std::uint32_t vertex = mesh.render.triangles[t][k], before = whole.render.triangles[t][k];
      EXPECT_EQ(mesh.render.positions[vertex], whole.render.positions[before]);
      EXPECT_EQ(mesh.render.uvs[vertex].x, whole.render.uvs[before].x);
    }
}

// A seam of texture coordinates has several vertices at a point: those of one side alone go along, the others are doubled.
TEST(Splits, at_seams_double_only_the_vertices_that_both_sides_have) {
  RenderMesh render;
  render.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 0}};   // the last is the first again, with another UV
  render.uvs = {{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}, {0.5f, 0.5f}};
  render.triangles = {{0, 1, 2}, {0, 2, 3}, {5, 3, 4}, {5, 4, 1}};
  Mesh mesh = must(weld_mesh(std::move(render)));
  ASSERT_EQ(mesh.points.size(), 5u);
  add_spares(mesh, 4);
  const std::uint32_t centre = mesh.point_of[0];
  const std::vector<Split> along_the_seam = {{centre, {6, 9}}};
  Mesh once = mesh;
  ASSERT_EQ(must(split_points(once, along_the_seam)), 1u);
  EXPECT_EQ(once.spare_vertices, 4u);   // none was needed
  const std::vector<Split> across = {{centre, {0, 9}}};
  ASSERT_EQ(must(split_points(mesh, across)), 1u);
  EXPECT_EQ(mesh.spare_vertices, 2u);
  EXPECT_EQ(mesh.spare_points, 3u);
  EXPECT_TRUE(check(mesh)) << check(mesh).error();
  EXPECT_TRUE(check(once)) << check(once).error();
}

TEST(Splits, that_cannot_be_are_refused_or_left_out) {
  const Mesh whole = tearable(4, 1);
  const auto said = [&](const Split& split) {
    Mesh mesh = whole;
    const auto done = split_points(mesh, std::span(&split, 1));
    return done ? std::string("done") : done.error();
  };
  EXPECT_EQ(said({99, {0}}), "a split: 99 is not one of the 25 points");
  EXPECT_EQ(said({12, {}}), "a split of point 12: 0 of its 6 corners are none or all of them");
  EXPECT_EQ(said(split_of(whole, 12, 0, 6)), "a split of point 12: 6 of its 6 corners are none or all of them");
  EXPECT_EQ(said({12, {4000}}), "a split: corner 4000 is of none of the 32 triangles");
  EXPECT_EQ(said({12, {0}}), "a split: corner 0 is not of point 12");
  Split twice = split_of(whole, 12, 0, 2);
  twice.corners[1] = twice.corners[0];
  EXPECT_EQ(said(twice), "a split: corner " + std::to_string(twice.corners[0]) + " is not above the one before");
  Mesh mesh = whole;
  const std::vector<Split> two = {split_of(whole, 12, 0, 3), split_of(whole, 7, 0, 3)};
  EXPECT_EQ(must(split_points(mesh, two)), 1u);   // there is one spare vertex
  EXPECT_EQ(mesh.points.size(), 26u);
}

TEST(Splits, have_no_more_room_than_there_are_corners_to_split) {
  Scene scene = without_contacts();
  scene.cloths.emplace_back().grid = Grid{{1, 1}, 4, 4, Topology::diagonal, true};
  scene.cloths[0].tear = Tear{.spare = 1000000};
  auto meshes = must(make_meshes(scene));
  add_spares(scene, meshes);
  EXPECT_EQ(meshes[0].spare_points, 3u * 32 - 25);
  EXPECT_EQ(meshes[0].point_of.size(), 96u);
}

// However cloth is torn, also into small pieces, it can be cooked; its particles keep their numbers and its mass stays.
TEST(Splits, of_any_kind_can_be_cooked) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    std::mt19937 words(seed);
    Scene scene = without_contacts();
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{1, 1}, 24, 24, seed == 2 ? Topology::centre : Topology::diagonal, true};
    cloth.tear = Tear{.spare = 1200};
    cloth.anchors.emplace_back().top = 0.001;
    scene.contacts.enabled = true;
    scene.solver.method = seed == 3 ? Method::gauss_seidel : Method::by_default;
    auto meshes = must(make_meshes(scene));
    add_spares(scene, meshes);
    CookedFabric fabric = must(cook(scene, meshes));
    const CookedFabric whole = fabric;
    const auto mass = [](const CookedFabric& f) {
      double sum = 0;
      for (const gpu::vec4& p : f.positions)
        if (p.w > 0) sum += 1 / double(p.w);
      return sum;
    };
    for (int round = 0; round < 4; ++round) {
      Mesh& mesh = meshes[0];
      const cooking::Fans fans(mesh);
      std::vector<Split> splits;
      for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
        const auto all = fans.of(p);
        const bool is_anchor = std::ranges::any_of(fabric.anchors, [&](const AnchorTarget& a) { return a.rest == mesh.points[p]; });
        if (words() % 8 != 0 || is_anchor || (all.size() == 1 && all[0].corners.size() < 2)) continue;
        auto corners = all[0].corners;
        if (all.size() == 1) corners.resize(1 + words() % (corners.size() - 1));
        std::ranges::sort(corners);
        splits.push_back({p, corners});
      }
      ASSERT_EQ(must(split_points(mesh, splits)), splits.size());
      ASSERT_TRUE(check(mesh)) << check(mesh).error();
      fabric = must(torn_anew(scene, meshes, fabric));
    }
    EXPECT_GT(pieces(meshes[0]), 2u);
    EXPECT_EQ(fabric.positions.size(), whole.positions.size());
    EXPECT_EQ(fabric.cloth_triangles, whole.cloth_triangles);
    EXPECT_EQ(fabric.anchors.size(), whole.anchors.size());
    EXPECT_NEAR(mass(fabric), mass(whole), 1e-6 * mass(whole));
    const auto again = must(torn_anew(scene, meshes, whole));   // at once, from the whole
    EXPECT_EQ(digest_of(scene, again), digest_of(scene, fabric));
  }
}

}  // namespace
}  // namespace weft
