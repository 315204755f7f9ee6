// Where overstretched cloth tears, and where a blade cuts it.
#include <gtest/gtest.h>

#include "tests/effects/tear/torn.h"

namespace weft {
namespace {

using cooking::cracks;
using cooking::cut_by;
using Eigen::Vector3d;

std::vector<float> limits(const Mesh& mesh, float strain) { return std::vector<float>(mesh.points.size(), strain); }

// The sheet's middle row of cells drawn out along y.
std::vector<Vector3d> pulled(const Mesh& mesh, double by) {
  auto places = places_of(mesh);
  for (Vector3d& p : places)
    if (p.y() > 0.001) p.y() += by;
  return places;
}

TEST(Cracks, run_across_the_pull_from_rim_to_rim) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    Mesh mesh = tearable(8, 64, topology);
    const auto places = pulled(mesh, 0.2);
    const auto splits = cracks({mesh, places, nobody}, limits(mesh, 0.5f));
    ASSERT_EQ(must(split_points(mesh, splits)), splits.size());
    EXPECT_EQ(splits.size(), topology == Topology::diagonal ? 9u : 10u) << "one of each point along it";
    EXPECT_EQ(pieces(mesh), 2u);
    EXPECT_TRUE(check(mesh)) << check(mesh).error();
  }
}

TEST(Cracks, begin_only_where_an_edge_is_beyond_its_limit) {
  const Mesh mesh = tearable(8, 64);
  const auto places = pulled(mesh, 0.05);   // the cells are 0.125 m
  EXPECT_TRUE(cracks({mesh, places, nobody}, limits(mesh, 0.5f)).empty());
  EXPECT_FALSE(cracks({mesh, places, nobody}, limits(mesh, 0.3f)).empty());
  std::vector<float> weak = limits(mesh, 0.5f);
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p)
    if (mesh.points[p].x < -0.1f) weak[p] = 0.1f;
  const auto splits = cracks({mesh, places, nobody}, weak);
  ASSERT_FALSE(splits.empty());
  for (const Split& split : splits) EXPECT_LT(mesh.points[split.point].x, 0.01f) << "a painted weakness is where it tears";
}

TEST(Cracks, split_nothing_that_is_held) {
  Mesh mesh = tearable(8, 64);
  const auto places = pulled(mesh, 0.2);
  const auto is_held = [&](std::uint32_t p) { return std::abs(mesh.points[p].x) < 0.01f; };
  for (const Split& split : cracks({mesh, places, is_held}, limits(mesh, 0.5f))) EXPECT_FALSE(is_held(split.point));
}

// Stretched evenly, everything is beyond its limit, and one crack has to do for the cloth on both of its sides.
TEST(Cracks, relieve_the_cloth_beside_them) {
  Mesh mesh = tearable(16, 300);
  auto places = places_of(mesh);
  for (Vector3d& p : places) p.y() *= 2;
  const auto splits = cracks({mesh, places, nobody}, limits(mesh, 0.5f));
  EXPECT_EQ(splits.size(), 17u);
  ASSERT_EQ(must(split_points(mesh, splits)), splits.size());
  EXPECT_EQ(pieces(mesh), 2u);
}

TEST(Cracks, part_what_hangs_together_by_a_point) {
  Mesh mesh = tearable(2, 8);
  // A slit from the left rim to the middle, and one from the right: the halves hang together by the point in the middle.
  const cooking::Blade left{{-1, 0.001, 1}, {0, 0, -1}, {0.9, 0, -1}}, right{{1, 0.001, 1}, {0, 0, -1}, {-0.9, 0, -1}};
  for (const cooking::Blade& blade : {left, right}) {
    const auto places = places_of(mesh);
    const auto splits = cut_by({mesh, places, [](std::uint32_t p) { return p == 4; }}, blade);
    ASSERT_EQ(must(split_points(mesh, splits)), splits.size());
  }
  ASSERT_EQ(pieces(mesh), 1u);
  ASSERT_EQ(cooking::Fans(mesh).of(4).size(), 2u);
  auto places = places_of(mesh);
  for (const Triangle& t : mesh.triangles) {
    const bool is_upper = places_of(mesh)[t[0]].y() + places_of(mesh)[t[1]].y() + places_of(mesh)[t[2]].y() > 0;
    for (const std::uint32_t p : t)
      if (is_upper && p != 4) places[p].y() = mesh.points[p].y + 1;
  }
  const auto splits = cracks({mesh, places, nobody}, limits(mesh, 0.5f));
  ASSERT_FALSE(splits.empty());
  ASSERT_EQ(must(split_points(mesh, splits)), splits.size());
  EXPECT_EQ(pieces(mesh), 2u);
}

TEST(Blades, cut_a_sheet_in_two_wherever_they_go) {
  for (const Topology topology : {Topology::diagonal, Topology::centre})
    for (int k = 0; k < 12; ++k) {
      const double angle = 0.26 * k;
      const Vector3d along(std::cos(angle), std::sin(angle), 0);
      Mesh mesh = tearable(9, 200, topology);
      const auto places = places_of(mesh);
      const cooking::Blade blade{{0.013, 0.021, 2}, Vector3d(0, 0, -1) - along, Vector3d(0, 0, -1) + along};
      const auto splits = cut_by({mesh, places, nobody}, blade);
      ASSERT_EQ(must(split_points(mesh, splits)), splits.size());
      EXPECT_TRUE(check(mesh)) << check(mesh).error();
      EXPECT_EQ(pieces(mesh), 2u) << "at " << angle;
    }
}

TEST(Blades, that_end_within_the_cloth_leave_a_slit) {
  Mesh mesh = tearable(8, 64);
  const auto places = places_of(mesh);
  const auto splits = cut_by({mesh, places, nobody}, {{0, 0.01, 2}, {-0.2, 0, -2}, {0.2, 0, -2}});
  EXPECT_FALSE(splits.empty());
  ASSERT_EQ(must(split_points(mesh, splits)), splits.size());
  EXPECT_EQ(pieces(mesh), 1u);
  EXPECT_TRUE(cut_by({mesh, places_of(mesh), nobody}, {{0, 0, 2}, {3, 0, -1}, {3, 1, -1}}).empty()) << "beside the cloth";
  EXPECT_TRUE(cut_by({mesh, places_of(mesh), nobody}, {{0, 0.03, 2}, {-1, 0, 1}, {1, 0, 1}}).empty()) << "behind the eye";
}

}  // namespace
}  // namespace weft
