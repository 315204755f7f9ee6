// What a ray meets, and what is nearest to a point.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/solve/pick.h"

namespace weft {
namespace {

const std::vector<Vec3> kSquare = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<Triangle> kTwo = {{0, 1, 2}, {0, 2, 3}};

Vec3 point_of(const Hit& hit, const std::vector<Triangle>& triangles, const std::vector<Vec3>& points) {
  Vec3 sum;
  for (std::size_t k = 0; k < 3; ++k) sum = sum + static_cast<float>(hit.weights[k]) * points[triangles[hit.triangle][k]];
  return sum;
}

TEST(Pick, a_ray_meets_the_first_triangle_from_either_side) {
  for (const float side : {1.f, -1.f}) {
    const auto hit = first_on_ray(kTwo, kSquare, {0.75f, 0.25f, 3 * side}, {0, 0, -2 * side});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->triangle, 0u);
    EXPECT_DOUBLE_EQ(hit->distance, 3);
    EXPECT_LT(length(point_of(*hit, kTwo, kSquare) - Vec3{0.75f, 0.25f, 0}), 1e-6f);
    EXPECT_FALSE(first_on_ray(kTwo, kSquare, {0.75f, 0.25f, 3 * side}, {0, 0, side})) << "it is behind";
  }
  EXPECT_FALSE(first_on_ray(kTwo, kSquare, {1.5f, 0.5f, 1}, {0, 0, -1}));
  EXPECT_FALSE(first_on_ray(kTwo, kSquare, {-1, 0.5f, 0}, {1, 0, 0})) << "along the plane";
}

TEST(Pick, no_ray_slips_through_between_two_triangles) {
  for (int k = 0; k <= 100; ++k) {
    const float t = 0.01f * static_cast<float>(k);
    EXPECT_TRUE(first_on_ray(kTwo, kSquare, {t, t, 1}, {0, 0, -1})) << t;
  }
}

TEST(Pick, triangles_without_area_or_place_are_passed_over) {
  std::vector<Vec3> points = kSquare;
  points.insert(points.end(), {{0.5f, 0.2f, 0.5f}, {0.5f, 0.2f, 0.5f}, {NAN, 0, 0.5f}});
  const std::vector<Triangle> triangles = {{4, 5, 4}, {4, 5, 6}, {0, 1, 2}, {0, 2, 3}};
  const auto hit = first_on_ray(triangles, points, {0.5f, 0.2f, 1}, {0, 0, -1});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->triangle, 2u);
  const auto nearest = nearest_to(std::span(triangles).subspan(1), points, {0.5f, 0.2f, 0.6f});
  ASSERT_TRUE(nearest);
  EXPECT_EQ(nearest->triangle, 1u);
  EXPECT_FALSE(nearest_to(std::span(triangles).subspan(1, 1), points, {0, 0, 0}));
}

// Against a search through many points of the triangle.
TEST(Pick, no_point_of_a_triangle_is_nearer_than_the_nearest) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> any(-1, 1);
  const auto anywhere = [&] { return Vec3{any(random), any(random), any(random)}; };
  for (int trial = 0; trial < 300; ++trial) {
    const std::vector<Vec3> points = {anywhere(), anywhere(), anywhere()};
    const std::vector<Triangle> one = {{0, 1, 2}};
    const Vec3 from = anywhere();
    const auto hit = nearest_to(one, points, from);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(length(point_of(*hit, one, points) - from), hit->distance, 1e-5);
    double least = 1e9;
    for (int u = 0; u <= 60; ++u)
      for (int v = 0; u + v <= 60; ++v) {
        const float a = static_cast<float>(u) / 60, b = static_cast<float>(v) / 60;
        least = std::min<double>(least, length((1 - a - b) * points[0] + a * points[1] + b * points[2] - from));
      }
    EXPECT_LE(hit->distance, least + 1e-6);
    EXPECT_GT(hit->distance, least - 0.05);
  }
}

}  // namespace
}  // namespace weft
