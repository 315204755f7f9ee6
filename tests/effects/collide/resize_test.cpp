// Colliders that the host resizes: they grow and shrink evenly through a frame, push cloth no faster than their surface moves, and let none
// through.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/effects/collide/collide.h"
#include "shaders/collide/collide.ref.h"
#include "tests/support/cooked.h"
#include "tests/support/single_pass.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using Resize = GpuTest;
using reference::Vector;

Collider resizable(ColliderShape shape, Vec3 centre) {
  Collider collider;
  collider.shape = shape;
  collider.centre = centre;
  collider.radius = 0.1;
  collider.length = 0.4;
  collider.axis = shape == ColliderShape::capsule ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  collider.size = {0.2f, 0.2f, 0.2f};
  collider.resizes = true;
  return collider;
}

reference::Body body_of(const Simulation& simulation, std::uint32_t k) {
  const Collider& collider = simulation.scene().colliders[k];
  const ColliderPose& pose = simulation.colliders()[k];
  const ColliderSize& size = simulation.collider_sizes()[k];
  reference::Body body;
  body.shape = static_cast<reference::Shape>(collider.shape);
  body.radius = size.radius;
  if (collider.shape == ColliderShape::capsule) body.taper = size.radius - size.radius_end;
  body.half_size = collider.shape == ColliderShape::box ? Vector(size.size.x / 2, size.size.y / 2, size.size.z / 2)
                                                        : Vector(0, size.length / 2, 0);
  body.centre_after = {pose.centre.x, pose.centre.y, pose.centre.z};
  body.rotation_after = Eigen::Quaterniond(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  return body;
}

// How fast those who touch it leave it, at most (m/s).
double fastest_off(const Simulation& simulation, std::uint32_t k) {
  const reference::Body body = body_of(simulation, k);
  const auto positions = must(simulation.read_positions()), velocities = must(simulation.read_velocities());
  double most = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (reference::signed_distance(body, vector(positions[i])) < 0.004)
      most = std::max(most, reference::distance_gradient(body, vector(positions[i])).dot(vector(velocities[i])));
  return most;
}

// How deep the deepest place of cloth is in it (m), also between vertices.
double deepest(const Simulation& simulation, std::uint32_t k) {
  const reference::Body body = body_of(simulation, k);
  const auto positions = must(simulation.read_positions());
  double most = -INFINITY;
  for (const auto& [a, b, c] : simulation.fabric().triangles)
    for (int i = 0; i <= 6; ++i)
      for (int j = 0; i + j <= 6; ++j) {
        const double u = i / 6.0, v = j / 6.0;
        const Vector p = (1 - u - v) * vector(positions[a]) + u * vector(positions[b]) + v * vector(positions[c]);
        most = std::max(most, -reference::signed_distance(body, p));
      }
  return most;
}

// A sheet lies over a body, which then grows to twice its size in half a second and shrinks to less than it was.
TEST_F(Resize, a_body_that_grows_lifts_the_sheet_over_it_no_faster_than_its_surface_and_shows_through_nowhere) {
  for (const ColliderShape shape : {ColliderShape::sphere, ColliderShape::capsule, ColliderShape::box})
    for (const std::uint32_t cells : {6u, 24u, 52u}) {   // the finest is held (shaders/support)
      SCOPED_TRACE("shape " + std::to_string(int(shape)) + ", cells " + std::to_string(cells));
      Scene scene = sheet(cells);
      scene.cloths[0].transform.translate = {0.02f, 0.12f, 0.01f};
      scene.cloths[0].fabric.damping = 2;
      scene.colliders = {resizable(shape, {0, 0, 0}), plane(-0.5f)};
      const auto simulation = must(Simulation::create(device(), scene));
      run(*simulation, 1.5);
      double most = 0, deep = 0;
      for (int k = 1; k <= 30; ++k) {
        const double factor = 1 + k / 30.0;
        const auto side = static_cast<float>(0.2 * factor);
        must(simulation->resize_collider(0, {0.1 * factor, 0.1 * (1 + 0.5 * k / 30), 0.4, {side, side, side}}));
        must(simulation->advance(kFrame));
        deep = std::max(deep, deepest(*simulation, 0));
        most = std::max(most, fastest_off(*simulation, 0));
      }
      // Fine cloth that is dragged round the edges of a box lags behind them: a limitation (engine/README.md, "Sizes").
      const bool box = shape == ColliderShape::box;
      EXPECT_LT(deep, box ? 0.004 : 0.001);
      if (cells >= 24) { EXPECT_GT(most, 0.1); }   // of coarse cells few corners touch it
      // Finer cloth swings at up to 0.7 m/s, 1.9 over a box, whether it is held or not.
      if (cells <= 24) { EXPECT_LT(most, box ? 1 : 0.5) << "of a surface that moves at 0.2 m/s, edges and corners of a box at 0.35; hanging cloth swings besides"; }
      EXPECT_EQ(simulation->collider_sizes()[0].radius, shape == ColliderShape::box ? 0.1 : 0.2);
      for (int k = 1; k <= 30; ++k) {
        const auto side = static_cast<float>(0.4 - 0.01 * k);
        must(simulation->resize_collider(0, {0.2 - 0.005 * k, 0.15 - 0.004 * k, 0.4 - 0.01 * k, {side, side, side}}));
        must(simulation->advance(kFrame));
        ASSERT_LT(deepest(*simulation, 0), box ? 0.012 : 0.002) << "shrinking, " << k;
      }
      run(*simulation, 0.5);
      EXPECT_LT(deepest(*simulation, 0), 0.001);
      EXPECT_EQ(simulation->counts().non_finite, 0u);
    }
}

// From far smaller to far larger than a cell in one frame, below an even sheet: nobody passes, and nobody leaves faster than the surface
// came.
TEST_F(Resize, growth_within_a_frame_goes_through_no_sheet_and_gives_its_own_speed) {
  for (const ColliderShape shape : {ColliderShape::sphere, ColliderShape::capsule, ColliderShape::box}) {
    SCOPED_TRACE(static_cast<int>(shape));
    Scene scene = sheet(10);
    scene.solver.method = Method::jacobi;   // cloth that gives way: what does not hands speed on to its corners, which whip
    scene.solver.levels = true;
    scene.gravity = {0, 0, 0};
    scene.colliders = {resizable(shape, {0.03f, -0.12f, 0.03f})};
    const auto simulation = must(Simulation::create(device(), scene));
    must(simulation->resize_collider(0, {0.3, 0.3, 0.4, {0.6f, 0.6f, 0.6f}}));
    must(simulation->advance(kFrame));
    EXPECT_LT(deepest(*simulation, 0), 0.02) << "of triangles, of whose depth a substep makes up half";
    for (int k = 0; k < 3; ++k) must(simulation->advance(kFrame));
    EXPECT_LT(deepest(*simulation, 0), 0.004);
    const double surface = (shape == ColliderShape::box ? std::numbers::sqrt3 : 1) * 0.2 / kFrame;   // m/s; of a box the corners
    EXPECT_LT(top_speed(*simulation), 1.25 * surface);
    double lowest = INFINITY;
    for (const gpu::vec4& x : must(simulation->read_positions())) lowest = std::min(lowest, double(x.y));
    EXPECT_GT(lowest, -0.12) << "a part of the sheet is below the middle";
  }
}

TEST_F(Resize, every_way_gives_the_same_bits_and_a_snapshot_goes_on) {
  Scene scene = sheet(10);
  scene.cloths[0].transform.translate = {0, 0.12f, 0};
  scene.colliders = {resizable(ColliderShape::capsule, {0, 0, 0}), plane(-0.5f)};
  std::uint64_t hash = 0;
  for (const Way way : kWays) {
    auto simulation = must(Simulation::create(device(), scene));
    for (int k = 0; k < 20; ++k) {
      must(simulation->resize_collider(0, {0.1 + 0.005 * k, 0.1, 0.4, {}}));
      if (k == 10 && way == Way::submit) simulation = resumed(device(), *simulation, scene);   // with a size that is to come
      run_frame(device(), *simulation, way);
    }
    if (hash == 0) hash = hash_of(*simulation);
    EXPECT_EQ(hash_of(*simulation), hash) << static_cast<int>(way);
    EXPECT_EQ(simulation->collider_sizes()[0].radius, 0.1 + 0.005 * 19);
  }
}

TEST_F(Resize, what_cannot_be_is_refused_and_changes_nothing) {
  Scene scene = sheet(4);
  scene.colliders = {resizable(ColliderShape::capsule, {0, -1, 0}), sphere({0, -3, 0}, 0.2), plane(-5)};
  scene.colliders[2].resizes = true;
  const auto simulation = must(Simulation::create(device(), scene));
  const auto fault = [&](std::uint32_t k, const ColliderSize& size) {
    const auto done = simulation->resize_collider(k, size);
    return done ? std::string("no fault") : done.error();
  };
  EXPECT_EQ(fault(0, {.radius = 0}), "the radius of collider 0 is 0 m, not above 0 and at most 100000 m");
  EXPECT_EQ(fault(0, {.radius_end = NAN}), "the radius_end of collider 0 is nan m, not above 0 and at most 100000 m");
  EXPECT_EQ(fault(0, {.length = -1}), "the length of collider 0 is -1 m, not above 0 and at most 100000 m");
  EXPECT_EQ(fault(3, {}), "collider 3 is not below the scene's 3");
  for (const std::uint32_t k : {1u, 2u}) EXPECT_NE(fault(k, {}).find("may not be resized"), std::string::npos) << k;
  must(simulation->advance(kFrame));
  EXPECT_EQ(simulation->collider_sizes()[0], size_of(scene.colliders[0]));
  Snapshot snapshot = must(simulation->save());
  snapshot.colliders[1].size.radius = 0.3;
  EXPECT_FALSE(simulation->fits(snapshot)) << "it may not be resized";
  snapshot.colliders[1].size.radius = 0.2;
  snapshot.colliders[0].size.length = INFINITY;
  EXPECT_FALSE(simulation->fits(snapshot));
}

TEST_F(Resize, who_does_not_ask_has_no_buffer_for_it) {
  Scene scene = sheet(4);
  scene.colliders = {sphere({0, -1, 0}, 0.2)};
  const auto has_row = [&] {
    const auto simulation = must(Simulation::create(device(), scene));
    for (const BufferUse& buffer : simulation->buffers())
      if (buffer.name == "body_sizes") return true;
    return false;
  };
  EXPECT_FALSE(has_row());
  scene.colliders[0].resizes = true;
  EXPECT_TRUE(has_row());
}

}  // namespace
}  // namespace weft
