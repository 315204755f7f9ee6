// Geodesic distances to anchors: exact where the cloth unrolls flat, never too short, and only where there is a way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "engine/cook/parts.h"

namespace weft {
namespace {

using cooking::AnchorDistance;
using cooking::nearest_anchors;
using cooking::vector;

double to_first(const std::vector<AnchorDistance>& nearest) { return nearest.empty() ? NAN : nearest.front().distance; }
double straight(const Mesh& mesh, std::uint32_t a, std::uint32_t b) { return (vector(mesh.points[a]) - vector(mesh.points[b])).norm(); }
Mesh grid(float width, float height, std::uint32_t nx, std::uint32_t ny, Topology topology) {
  return make_grid(Grid{{width, height}, nx, ny, topology, true});
}

// Keeps the triangles for which `kept` holds, points and all.
template <class Kept>
Mesh cut(const Mesh& mesh, Kept kept) {
  RenderMesh render;
  render.positions = mesh.points;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d middle = (vector(mesh.points[t[0]]) + vector(mesh.points[t[1]]) + vector(mesh.points[t[2]])) / 3;
    if (kept(middle)) render.triangles.push_back(t);
  }
  auto made = weld_mesh(std::move(render));
  EXPECT_TRUE(made) << made.error();
  return made ? std::move(*made) : Mesh{};
}

std::uint32_t nearest_point(const Mesh& mesh, Eigen::Vector3d place) {
  std::uint32_t best = 0;
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p)
    if ((vector(mesh.points[p]) - place).norm() < (vector(mesh.points[best]) - place).norm()) best = p;
  return best;
}

// Sides are powers of two, so that points are where they should be to the bit.
TEST(Geodesic, flat_grids_are_exact_in_both_topologies) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    const Mesh mesh = grid(1, 1, 32, 32, topology);
    for (const std::uint32_t anchor : {0u, 16u, 33u * 16 + 16, 33u * 33 - 1, 33u * 7 + 20}) {
      const std::uint32_t anchors[] = {anchor};
      const auto nearest = nearest_anchors(mesh, anchors, 1);
      for (std::uint32_t p = 0; p < mesh.points.size(); ++p) ASSERT_NEAR(to_first(nearest[p]), straight(mesh, p, anchor), 1e-9) << p;
    }
  }
}

// Inner points move within the plane by up to a third of a cell, so that many triangles are obtuse; the rim stays straight, so that no
// way bends.
TEST(Geodesic, flat_irregular_sheets_are_exact) {
  Mesh mesh = grid(1, 1, 32, 32, Topology::diagonal);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<float> shift(-0.33f / 32, 0.33f / 32);
  for (Vec3& p : mesh.points)
    if (std::max(std::abs(p.x), std::abs(p.y)) < 0.5f) p = {p.x + shift(random), p.y + shift(random), 0};
  const std::uint32_t anchors[] = {0};
  const auto nearest = nearest_anchors(mesh, anchors, 1);
  double worst = 0;
  for (std::uint32_t p = 1; p < mesh.points.size(); ++p) {
    const double ratio = to_first(nearest[p]) / straight(mesh, p, 0);
    ASSERT_GE(ratio, 1 - 1e-12);
    worst = std::max(worst, ratio);
  }
  EXPECT_LT(worst, 1 + 1e-9);
}

// A quarter of a metre of radius, all the way round: the shorter way of the two.
TEST(Geodesic, a_cylinder_is_its_unrolled_distance) {
  constexpr double kRadius = 0.25, kAround = 2 * std::numbers::pi * kRadius, kHeight = 1;
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    Mesh flat = grid(1, 1, 64, 48, topology);
    RenderMesh render;
    for (const Vec3 p : flat.points) {
      const double turn = 2 * std::numbers::pi * p.x;
      render.positions.push_back(
          {static_cast<float>(kRadius * std::sin(turn)), static_cast<float>(p.y * kHeight), static_cast<float>(kRadius * std::cos(turn))});
    }
    render.triangles = flat.triangles;
    const auto mesh = weld_mesh(std::move(render));   // closes the seam
    ASSERT_TRUE(mesh) << mesh.error();
    const std::uint32_t anchor = 65 * 24 + 5;
    const std::uint32_t anchors[] = {mesh->point_of[anchor]};
    const auto nearest = nearest_anchors(*mesh, anchors, 1);
    for (std::uint32_t v = 0; v < flat.points.size(); ++v) {
      if (mesh->point_of[v] == anchors[0]) continue;
      const double part = std::abs(double(flat.points[v].x) - flat.points[anchor].x);
      const double expected = std::hypot(std::min(part, 1 - part) * kAround, (double(flat.points[v].y) - flat.points[anchor].y) * kHeight);
      ASSERT_NEAR(to_first(nearest[mesh->point_of[v]]) / expected, 1, 0.01) << v;
    }
  }
}

// On a torus the outer equator is 2 pi (R + r) long, and the shortest way along a meridian 2 pi r; both are geodesics.
TEST(Geodesic, a_torus_has_its_meridians_and_short_ways_along_its_equator) {
  constexpr double kLarge = 1, kSmall = 0.3;
  constexpr std::uint32_t kN = 96, kM = 48;
  RenderMesh render;
  for (std::uint32_t j = 0; j < kM; ++j)
    for (std::uint32_t i = 0; i < kN; ++i) {
      const double u = 2 * std::numbers::pi * i / kN, v = 2 * std::numbers::pi * j / kM, ring = kLarge + kSmall * std::cos(v);
      render.positions.push_back(
          {static_cast<float>(ring * std::cos(u)), static_cast<float>(kSmall * std::sin(v)), static_cast<float>(ring * std::sin(u))});
    }
  for (std::uint32_t j = 0; j < kM; ++j)
    for (std::uint32_t i = 0; i < kN; ++i) {
      const std::uint32_t a = j * kN + i, b = j * kN + (i + 1) % kN, c = (j + 1) % kM * kN + (i + 1) % kN, d = (j + 1) % kM * kN + i;
      render.triangles.push_back({a, b, c});
      render.triangles.push_back({a, c, d});
    }
  const auto mesh = weld_mesh(std::move(render));
  ASSERT_TRUE(mesh) << mesh.error();
  const std::uint32_t anchors[] = {mesh->point_of[0]};
  const auto nearest = nearest_anchors(*mesh, anchors, 1);
  for (std::uint32_t j = 1; j < kM; ++j)
    EXPECT_NEAR(to_first(nearest[mesh->point_of[j * kN]]) / (2 * std::numbers::pi * kSmall * std::min(j, kM - j) / kM), 1, 0.01) << j;
  // Along the outer equator only as far as no way over the top is shorter: a conjugate point lies pi sqrt(r (R + r)) away.
  for (std::uint32_t i = 1; i < kN / 6; ++i)
    EXPECT_NEAR(to_first(nearest[mesh->point_of[i]]) / (2 * std::numbers::pi * (kLarge + kSmall) * i / kN), 1, 0.01) << i;
}

// A square without its upper right quarter: from the end of one arm to the other the way bends at the inner corner.
TEST(Geodesic, an_l_shaped_sheet_bends_its_ways_at_the_corner) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    const Mesh mesh = cut(grid(2, 2, 48, 48, topology), [](const Eigen::Vector3d& m) { return m.x() < 0 || m.y() < 0; });
    const std::uint32_t anchors[] = {nearest_point(mesh, {-0.25, 1, 0})};
    const Eigen::Vector2d from = vector(mesh.points[anchors[0]]).head<2>(), corner(0, 0);
    const auto nearest = nearest_anchors(mesh, anchors, 1);
    double longest = 0;
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
      const Eigen::Vector2d to = vector(mesh.points[p]).head<2>();
      // Straight, unless the line passes through the quarter that is gone: then the corner lies on its left.
      const double side = (to - from).x() * (corner - from).y() - (to - from).y() * (corner - from).x();
      const bool bent = to.x() > 0 && side < 0;
      const double expected = bent ? (corner - from).norm() + (to - corner).norm() : (to - from).norm();
      if (expected == 0) continue;
      const double ratio = to_first(nearest[p]) / expected;
      ASSERT_GE(ratio, 1 - 1e-6) << to.transpose();
      longest = std::max(longest, ratio);
    }
    EXPECT_LT(longest, 1.03);
    RecordProperty("longest", std::to_string(longest));
  }
}

TEST(Geodesic, every_point_gets_its_nearest_anchors_nearest_first) {
  const Mesh mesh = grid(1, 1, 32, 32, Topology::centre);
  std::mt19937_64 random(3);
  std::vector<std::uint32_t> anchors(mesh.points.size());
  for (std::uint32_t p = 0; p < anchors.size(); ++p) anchors[p] = p;
  std::shuffle(anchors.begin(), anchors.end(), random);
  anchors.resize(25);
  for (const std::uint32_t count : {1u, 4u, 8u}) {
    const auto nearest = nearest_anchors(mesh, anchors, count);
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
      std::vector<double> expected;
      for (const std::uint32_t anchor : anchors) expected.push_back(straight(mesh, p, anchor));
      std::sort(expected.begin(), expected.end());
      ASSERT_EQ(nearest[p].size(), count);
      for (std::uint32_t k = 0; k < count; ++k) {
        // Where nearer anchors leave no place for the last ones, their distances follow edges for a step or two.
        EXPECT_GE(nearest[p][k].distance, straight(mesh, p, anchors[nearest[p][k].anchor]) * (1 - 1e-12));
        EXPECT_NEAR(nearest[p][k].distance, expected[k], k == 0 ? 1e-9 : 0.03 * expected[k]) << p << " " << k;
        if (k > 0) {
          EXPECT_GE(nearest[p][k].distance, nearest[p][k - 1].distance);
          EXPECT_NE(nearest[p][k].anchor, nearest[p][k - 1].anchor);
        }
      }
    }
  }
}

TEST(Geodesic, a_piece_without_an_anchor_has_no_distance) {
  const Mesh mesh = cut(grid(2, 1, 32, 16, Topology::diagonal), [](const Eigen::Vector3d& m) { return std::abs(m.x()) > 0.2; });
  const std::uint32_t anchors[] = {nearest_point(mesh, {-1, 0, 0})};
  const auto nearest = nearest_anchors(mesh, anchors, 4);
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p) EXPECT_EQ(nearest[p].size(), mesh.points[p].x < 0 ? 1u : 0u);
}

TEST(Geodesic, fewer_anchors_than_asked_for_are_all_that_there_are) {
  const Mesh mesh = grid(1, 1, 4, 4, Topology::diagonal);
  const std::uint32_t anchors[] = {0, 24};
  for (const auto& nearest : nearest_anchors(mesh, anchors, 8)) EXPECT_EQ(nearest.size(), 2u);
}

TEST(Geodesic, no_place_for_an_anchor_is_no_distance) {
  const std::uint32_t anchors[] = {0};
  for (const auto& nearest : nearest_anchors(grid(1, 1, 2, 2, Topology::diagonal), anchors, 0)) EXPECT_TRUE(nearest.empty());
}

}  // namespace
}  // namespace weft
