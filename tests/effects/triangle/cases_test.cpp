// Edges and triangles against spheres, capsules and boxes: nothing shows through between vertices, and nothing hooks.
#include <gtest/gtest.h>

#include "engine/effects/triangle/triangle.h"
#include "shaders/triangle/gap.ref.h"
#include "tests/support/cooked.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using TriangleCollision = GpuTest;
using reference::Vector;

Collider box(Vec3 centre, Vec3 size, double friction = 0.4) {
  Collider collider;
  collider.shape = ColliderShape::box;
  collider.centre = centre;
  collider.size = size;
  collider.friction = friction;
  return collider;
}

// Thick at one end, thin at the other.
Collider tapered(Collider capsule, double radius_end) {
  capsule.radius_end = radius_end;
  return capsule;
}

// A sheet on a box, whose one hem is pulled off it by 2 m.
Scene hem(std::uint32_t cells, double speed, double friction) {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1.2f, 1.2f}, cells, cells, Topology::diagonal, false};
  cloth.transform.translate = {0, 0.005f, 0};
  Anchor& pulled = cloth.anchors.emplace_back();
  pulled.box = Anchor::Box{{0.599f, -9, -9}, {0.601f, 9, 9}};
  pulled.keys = {{0.2, {}, {0, 1, 0}, 0}, {0.2 + 2 / speed, {2, 0, 0}, {0, 1, 0}, 0}};
  scene.colliders = {box({0, -0.25f, 0}, {1, 0.5f, 1}, friction), plane(-0.5f)};
  return scene;
}

void expect_free(const compute::Device& device, const Scene& scene, double speed) {
  const auto simulation = must(Simulation::create(device, scene));
  run(*simulation, 0.7 + 2 / speed);
  EXPECT_LT(strain_of(*simulation).max, 1);
  for (const gpu::vec4& x : must(simulation->read_positions())) ASSERT_GT(x.x, 0.49f);
}

TEST_F(TriangleCollision, a_hem_slips_off_a_box_at_any_speed) {
  for (const double speed : {0.5, 5.0, 20.0}) expect_free(device(), hem(24, speed, 0.4), speed);
}

TEST_F(TriangleCollision, a_hem_slips_off_a_box_with_any_friction_and_cell) {
  for (const double friction : {0.0, 1.0})
    for (const std::uint32_t cells : {6u, 40u}) expect_free(device(), hem(cells, 3, friction), 3);
}

TEST_F(TriangleCollision, a_hem_slips_off_a_box_with_every_method_and_with_contacts) {
  Scene scene = hem(16, 3, 0.4);
  for (const Method method : {Method::jacobi, Method::gauss_seidel, Method::implicit}) {
    scene.solver.method = method;
    if (method == Method::implicit) {   // which the default solves too badly
      scene.cloths[0].tethers = false;
      scene.solver.substeps = 10;
      scene.solver.iterations = 100;
    }
    expect_free(device(), scene, 3);
  }
  scene = hem(16, 3, 0.4);
  scene.cloths[0].tethers = false;
  expect_free(device(), scene, 3);
  scene.contacts.enabled = true;
  expect_free(device(), scene, 3);
}

// The body of a collider without keys, or with a pose.
reference::Body body_of(const Collider& collider, const ColliderPose& pose) {
  reference::Body body;
  body.shape = static_cast<reference::Shape>(collider.shape);
  body.radius = collider.radius;
  if (collider.shape == ColliderShape::capsule) body.taper = collider.radius - radius_at_end(collider);
  body.half_size = collider.shape == ColliderShape::box ? Vector(0.5 * collider.size.x, 0.5 * collider.size.y, 0.5 * collider.size.z)
                                                        : Vector(0, 0.5 * collider.length, 0);
  body.centre_after = {pose.centre.x, pose.centre.y, pose.centre.z};
  body.rotation_after = Eigen::Quaterniond(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  return body;
}

// How deep the deepest of 66 points of every triangle is in a body (m); of its vertices alone where `vertices`.
double deepest(const Simulation& simulation, const reference::Body& body, bool vertices = false) {
  constexpr int kParts = 10;
  const auto positions = must(simulation.read_positions());
  double most = -INFINITY;
  const auto depth = [&](const Vector& p) { return -reference::signed_distance(body, p); };
  for (const auto& corners : simulation.fabric().triangles) {
    const Vector a = vector(positions[corners[0]]), b = vector(positions[corners[1]]), c = vector(positions[corners[2]]);
    const double of_corners = std::max({depth(a), depth(b), depth(c)});
    most = std::max(most, of_corners);
    // All of it is nearer to a corner than its longest side, and depth changes by no more than place does.
    if (vertices || of_corners < -std::sqrt(std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()}))) continue;
    for (int i = 0; i <= kParts; ++i)
      for (int j = 0; i + j <= kParts; ++j) {
        const double u = double(i) / kParts, v = double(j) / kParts;
        most = std::max(most, depth((1 - u - v) * a + u * b + v * c));
      }
  }
  return most;
}

Scene over(const Collider& collider, std::uint32_t cells) {
  Scene scene = sheet(cells);
  scene.cloths[0].transform.translate = {0.02f, 0.45f, 0.01f};
  scene.cloths[0].fabric.damping = 1;
  scene.colliders = {collider};
  return scene;
}

// Where the sheet lies. Where it strikes at 2 m/s an edge may be in the body by half its thickness, 1 mm, for a substep or two. At a box's
// corner triangles about one particle are put out in unlike directions: where it took the plain mean, fine cells rested 1 mm inside. Where
// what a corner or a thin end carries was not held (Supports), the finest were stretched twofold there, and rested 1.8 mm inside.
TEST_F(TriangleCollision, nothing_shows_through_a_draped_sheet_at_any_cell_size) {
  Collider turned = box({0, 0, 0}, {0.4f, 0.5f, 0.3f});
  turned.axis = {0.6f, 0.8f, 0};
  turned.degrees = 33;
  const Collider colliders[] = {sphere({0, 0.1f, 0}, 0.15), capsule({0, 0.2f, 0}, 0.04, 0.5, {0.8f, 0.6f, 0}),
                                tapered(capsule({0, 0.1f, 0}, 0.15, 0.5, {0.8f, 0.6f, 0}), 0.04),
                                tapered(capsule({0, 0.1f, 0}, 0.03, 0.4, {0.96f, -0.28f, 0}), 0.2),
                                tapered(capsule({0, 0.1f, 0}, 0.2, 0.1, {0.96f, -0.28f, 0}), 0.05),
                                box({0, 0, 0}, {0.4f, 0.5f, 0.3f}), turned};
  for (const Collider& collider : colliders)
    for (const std::uint32_t cells : {1u, 3u, 10u, 25u, 35u, 50u, 100u}) {
      SCOPED_TRACE("shape " + std::to_string(int(collider.shape)) + ", cells " + std::to_string(cells));
      const auto simulation = must(Simulation::create(device(), over(collider, cells)));
      const reference::Body body = body_of(collider, simulation->colliders()[0]);
      for (int k = 0; k < 12; ++k) {
        run(*simulation, 0.1);
        ASSERT_LT(deepest(*simulation, body), 0.001) << "after " << 0.1 * (k + 1) << " s";
      }
      EXPECT_LT(deepest(*simulation, body), 0);
    }
}

// The finest where colliders tell what they are given, or may change their size, and by jacobi, which gives way where a thin end strikes: by
// 2 mm (39 before the end held, and then the sheet was pierced).
TEST_F(TriangleCollision, nothing_shows_through_where_bodies_react_or_resize_or_cloth_gives_way) {
  const Collider colliders[] = {capsule({0, 0.2f, 0}, 0.04, 0.5, {0.8f, 0.6f, 0}), box({0, 0, 0}, {0.4f, 0.5f, 0.3f})};
  for (const Collider& collider : colliders)
    for (int kind = 0; kind < 3; ++kind) {
      SCOPED_TRACE("shape " + std::to_string(int(collider.shape)) + (kind == 0 ? ", reacts" : kind == 1 ? ", resizes" : ", by jacobi"));
      Scene scene = over(collider, 100);
      scene.reactions = kind == 0;
      scene.colliders[0].resizes = kind == 1;
      if (kind == 2) scene.solver.method = Method::jacobi;
      const auto simulation = must(Simulation::create(device(), scene));
      const reference::Body body = body_of(collider, simulation->colliders()[0]);
      for (int k = 0; k < 12; ++k) {
        run(*simulation, 0.1);
        ASSERT_LT(deepest(*simulation, body), kind == 2 ? 0.002 : 0.001) << "after " << 0.1 * (k + 1) << " s";
      }
      EXPECT_LT(deepest(*simulation, body), 0);
    }
}

// Small bodies through large cells, without a vertex near their way.
TEST_F(TriangleCollision, no_body_passes_between_vertices_however_fast) {
  const Collider colliders[] = {sphere({0.13f, -0.5f, 0.09f}, 0.03), capsule({0.13f, -0.5f, 0.09f}, 0.02, 0.1, {0.8f, 0, 0.6f}),
                                tapered(capsule({0.13f, -0.5f, 0.09f}, 0.02, 0.1, {0.8f, 0, 0.6f}), 0.05),
                                tapered(capsule({0.13f, -0.5f, 0.09f}, 0.05, 0.1, {0, 1, 0}), 0.01),
                                box({0.13f, -0.5f, 0.09f}, {0.05f, 0.03f, 0.04f})};
  for (const double speed : {5.0, 20.0, 60.0})
    for (Collider collider : colliders) {
      SCOPED_TRACE("shape " + std::to_string(int(collider.shape)) + " at " + std::to_string(speed) + " m/s");
      collider.keys = {{0, {}, {0, 1, 0}, 0}, {0.7 / speed, {0, 0.7f, 0}, {0, 1, 0}, 0}};
      Scene scene = sheet(4);
      scene.colliders = {collider};
      scene.cloths[0].anchors = {held_at({Corner::low_low, Corner::low_high, Corner::high_low, Corner::high_high})};
      scene.cloths[0].tethers = false;
      scene.gravity = {0, 0, 0};
      const auto simulation = must(Simulation::create(device(), scene));
      run(*simulation, 0.5);
      // The sheet lies over the body now, and is not pierced.
      EXPECT_LT(deepest(*simulation, body_of(collider, simulation->colliders()[0])), 0.001);
      double highest = 0;
      for (const gpu::vec4& x : must(simulation->read_positions())) highest = std::max(highest, double(x.y));
      EXPECT_GT(highest, 0.1);
    }
}

// From some starts what triangles ask and what links ask never agree, and a few particles go on moving (tests/README.md).
TEST_F(TriangleCollision, a_sheet_over_a_box_comes_to_rest) {
  int at_rest = 0;
  double farthest = 0;   // m, in a frame
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    Scene scene = over(box({0, 0, 0}, {0.4f, 0.5f, 0.3f}), 12);
    scene.cloths[0].fabric.damping = 4;
    scene.cloths[0].start.seed = seed;
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 10);
    at_rest += top_speed(*simulation) < 0.005 ? 1 : 0;
    const auto before = must(simulation->read_positions());
    run(*simulation, kFrame);
    const auto after = must(simulation->read_positions());
    for (std::size_t i = 0; i < after.size(); ++i) farthest = std::max(farthest, (vector(after[i]) - vector(before[i])).norm());
    EXPECT_LT(strain_of(*simulation).max, 0.2);
  }
  RecordProperty("at_rest", at_rest);
  RecordProperty("micrometres_a_frame", static_cast<int>(1e6 * farthest));
  EXPECT_GE(at_rest, 4);
  EXPECT_LT(farthest, 0.003);
}

// Fine cloth keeps out of round bodies by its vertices alone, and pays for no more than these.
TEST_F(TriangleCollision, are_looked_for_only_where_something_could_show_through) {
  const auto searches = [&](const Scene& scene) {
    const CookedFabric fabric = cooked(scene);
    const Needs needs = needs_of(cooked_of(scene, fabric), 64, true);
    return needs.has(EffectId::triangle);
  };
  const Collider ball = sphere({0, 0, 0}, 0.25), ground = plane(0);
  EXPECT_FALSE(searches(over(ball, 50)));
  EXPECT_TRUE(searches(over(ball, 10)));
  Collider cone = capsule({0, 0, 0}, 0.25, 0.5, {1, 0, 0});
  EXPECT_FALSE(searches(over(cone, 50)));
  EXPECT_TRUE(searches(over(tapered(cone, 0.02), 50))) << "by the thinner end";
  cone.resizes = true;
  EXPECT_TRUE(searches(over(cone, 50))) << "whatever size it gets";
  Scene apart = over(ball, 10);
  apart.colliders[0].meets.emplace();
  EXPECT_FALSE(searches(apart)) << "it meets no cloth";
  EXPECT_FALSE(searches(over(ground, 1)));
  EXPECT_TRUE(searches(over(box({0, 0, 0}, {1, 1, 1}), 50)));
}

// A cape's anchors lie in the shoulder that carries it, above its middle: where it starts across that, half of it may go out below.
TEST_F(TriangleCollision, anchors_inside_a_body_leave_the_cloth_around_them_calm) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    Scene scene = sheet(10);
    scene.colliders = {capsule({0, -0.03f, -0.45f}, 0.12, 1, {1, 0, 0})};
    scene.cloths[0].fabric.damping = 4;
    scene.cloths[0].start.seed = seed;
    scene.cloths[0].anchors.emplace_back().box = Anchor::Box{{-1, -1, -0.51f}, {1, 1, -0.49f}};
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 4);
    EXPECT_LT(top_speed(*simulation), 0.05);
    EXPECT_LT(strain_of(*simulation).max, 0.05);
  }
}

}  // namespace
}  // namespace weft
