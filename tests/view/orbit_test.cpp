// The viewer's camera.
#include "samples/view/orbit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace weft::view {
namespace {

constexpr double kAspect = 1.6;
constexpr double kTight = 1e-5;   // floats of a few metres, and a few operations

void expect_near(Vec3 a, Vec3 b, double tolerance) { EXPECT_LT(length(a - b), tolerance) << a.x << " " << a.y << " " << a.z; }

TEST(Orbit, begins_where_the_scenes_camera_is) {
  for (const Vec3 eye : {Vec3{0, 1, 4}, Vec3{3, 2, -1}, Vec3{-2, -0.5f, 0.1f}}) {
    const Camera camera{eye, {0.5f, 0.5f, 0}, 40};
    const Camera same = Orbit(camera).camera();
    expect_near(same.eye, camera.eye, kTight);
    expect_near(same.target, camera.target, kTight);
    EXPECT_EQ(same.fov_degrees, 40);
  }
}

TEST(Orbit, a_ray_through_a_place_of_the_picture_meets_the_point_that_is_seen_there) {
  const Camera camera = Orbit(Camera{{2, 1.5f, 3}, {0, 0.5f, 0}, 50}).camera();
  for (const Vec3 point : {Vec3{0, 0.5f, 0}, Vec3{0.4f, 0.9f, 0.3f}, Vec3{-0.7f, 0, 0.2f}}) {
    const Vec3 at = seen_at(camera, point, kAspect);
    const Ray ray = ray_through(camera, at.x, at.y, kAspect);
    expect_near(ray.origin + dot(point - ray.origin, ray.direction) * ray.direction, point, kTight);
  }
  expect_near(seen_at(camera, camera.target, kAspect), {0, 0, length(camera.target - camera.eye)}, kTight);
}

TEST(Orbit, turning_keeps_the_target_and_the_distance_and_stops_short_of_the_poles) {
  Orbit orbit(Camera{{0, 1, 4}, {0, 1, 0}, 40});
  orbit.turn(std::numbers::pi / 2, 0);   // the pointer goes right, and so does the scene: the eye goes left
  expect_near(orbit.camera().eye, {-4, 1, 0}, kTight);
  for (int k = 0; k < 50; ++k) orbit.turn(0.3, 0.4);
  const Camera above = orbit.camera();
  EXPECT_NEAR(length(above.eye - above.target), 4, 4 * kTight);
  EXPECT_LT(above.eye.y - above.target.y, 4);
  const Vec3 at = seen_at(above, {0.5f, 1, 0}, kAspect);   // there still is an up
  EXPECT_TRUE(std::isfinite(at.x) && std::isfinite(at.y));
}

TEST(Orbit, panning_by_a_height_takes_the_target_out_of_the_picture_by_as_much) {
  Orbit orbit(Camera{{1, 2, 4}, {0, 1, 0}, 40});
  orbit.pan(0.25, -0.5);
  const Vec3 at = seen_at(orbit.camera(), {0, 1, 0}, kAspect);
  EXPECT_NEAR(at.x * kAspect, 2 * 0.25, kTight);
  EXPECT_NEAR(at.y, -2 * 0.5, kTight);
}

TEST(Orbit, framing_shows_all_of_a_box_and_fills_the_picture) {
  Orbit orbit(Camera{{1, 2, 40}, {10, 1, 0}, 40});
  const Vec3 low{-1, -2, 0}, high{3, 1, 1};
  orbit.frame(low, high);
  double most = 0;
  for (unsigned k = 0; k < 8; ++k) {
    const Vec3 at = seen_at(orbit.camera(), {k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z}, 1);
    EXPECT_GT(at.z, 0);
    most = std::max<double>({most, std::abs(at.x), std::abs(at.y)});
  }
  EXPECT_LE(most, 1);
  EXPECT_GT(most, 0.5);
}

TEST(Orbit, a_box_without_a_size_and_one_that_is_not_finite_change_nothing) {
  Orbit orbit(Camera{{0, 1, 4}, {0, 1, 0}, 40});
  orbit.frame({1, 1, 1}, {1, 1, 1});
  orbit.frame({1, 1, 1}, {std::numeric_limits<float>::infinity(), 1, 1});
  expect_near(orbit.camera().eye, {0, 1, 4}, kTight);
  orbit.zoom(1e-30);
  EXPECT_GT(orbit.distance(), 0);
  orbit.zoom(1e30);
  EXPECT_TRUE(std::isfinite(orbit.distance()) && orbit.distance() < 1e5);
}

}  // namespace
}  // namespace weft::view
