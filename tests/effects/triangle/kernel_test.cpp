// Triangles against bodies, and the twin: still and fast, bodies that turn, larger and smaller than the triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "shaders/triangle/gap.ref.h"
#include "engine/effects/triangle/triangle.h"
#include "tests/support/bodies.h"

namespace weft {
namespace {

using TriangleKernel = GpuTest;
using reference::Vector;

// Triangles that share no particle, one body among them. No vertex collides: what is left of a step is what triangles asked for.
struct Trial {
  Scene scene = loose_scene(1);
  CookedFabric fabric;
  gpu::Collider collider{};
  std::vector<gpu::vec4> p;

  Trial(Random& random, ColliderShape shape, double size, double speed, double friction, std::uint32_t triangles = 1200,
        bool tapered = false) {
    scene.colliders.emplace_back().shape = shape;
    if (tapered) scene.colliders[0].radius_end = 0.1;
    fabric = loose_particles(random, 3 * triangles, scene.solver);
    fabric.own.of<TriangleLists>() = {1, shape != ColliderShape::box};
    fabric.cloth_triangles = triangles;
    for (gpu::Material& material : fabric.materials) material.friction = static_cast<float>(friction);
    for (std::uint32_t t = 0; t < triangles; ++t) {
      fabric.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
      const gpu::vec4 middle = anywhere(random, 0.6, 0), way = anywhere(random, speed, 0);
      for (std::uint32_t k = 0; k < 3; ++k) {
        gpu::vec4& x = fabric.positions[3 * t + k];
        const gpu::vec4 off = anywhere(random, size, 0), shift = anywhere(random, 0.05 * speed, 0);
        if (t % 8 != 0) x.w = fabric.iterate_weights[3 * t + k] = 1;   // the others have an anchor among them
        x = {middle.x + off.x, middle.y + off.y, middle.z + off.z, x.w};
        fabric.velocities[3 * t + k].w = std::bit_cast<float>(t % 2);
        p.push_back(x.w == 0 ? x : gpu::vec4{x.x + way.x + shift.x, x.y + way.y + shift.y, x.z + way.z + shift.z, x.w});
      }
    }
    const auto one = [&](double low, double high) { return static_cast<float>(between(random, low, high)); };
    collider.radius = one(0.1, 0.3);
    collider.friction = 1;
    collider.half_size = {one(0.1, 0.3), one(0.1, 0.3), one(0.1, 0.3)};
    collider.centre_to = {one(-0.2, 0.2), one(-0.2, 0.2), 0};
    const gpu::vec4 spin = anywhere(random, 1, 0);
    collider.spin = {spin.x, spin.y, spin.z};
    collider.normal_from = collider.normal_to = {0, 1, 0};
    const Eigen::Quaternionf q = Eigen::Quaternionf(one(-1, 1), one(-1, 1), one(-1, 1), one(-1, 1)).normalized();
    collider.rotation_from = {q.x(), q.y(), q.z(), q.w()};
    if (shape == ColliderShape::capsule) collider.half_size.x = collider.half_size.z = 0;
    if (tapered) {
      const double length = one(0.2, 0.6), low = one(0.05, 0.3);
      const gpu::BodySize of = body_size(shape, {low, low < 0.15 ? low + 0.15 : low - 0.1, length, {}});
      collider.radius = of.radius;
      collider.half_size = of.half_size;
    }
  }

  reference::Body body() const {
    reference::Body made;
    made.shape = static_cast<reference::Shape>(scene.colliders[0].shape);
    made.centre_before = vector(collider.centre_from);
    made.centre_after = vector(collider.centre_to);
    made.radius = collider.radius;
    made.half_size = vector(collider.half_size);
    if (made.shape == reference::Shape::capsule) put_taper(made, collider);
    const gpu::vec4& q = collider.rotation_from;
    made.rotation_before = Eigen::Quaterniond(q.w, q.x, q.y, q.z);
    const Vector spin = vector(collider.spin);
    made.rotation_after = Eigen::Quaterniond(Eigen::AngleAxisd(spin.norm(), spin.normalized())) * made.rotation_before;
    made.friction = std::sqrt(double(collider.friction) * fabric.materials[0].friction);
    return made;
  }

  // Six triangles meet in one particle.
  void share_corners() {
    for (std::uint32_t t = 0; t < fabric.triangles.size(); ++t) fabric.triangles[t][0] = 3 * (t - t % 6);
    fabric.own.of<TriangleLists>().most_around = 6;
    for (gpu::vec4& v : fabric.velocities) v.w = 0;   // of one material
  }

  // What the triangles asked of their corners: out of the body, and by friction (m).
  struct Asked {
    std::vector<Vector> out_of, friction;
  };
  Asked run(const compute::Device& device, bool gather_storage) {
    SinglePass passes(device, scene, fabric, gather_storage);
    passes.put_iterate(p);
    FrameInput input = frame_of(1);
    input.colliders = std::span(&collider, 1);
    passes.begin(input);
    passes.run("triangle_search");
    passes.run("triangle_collide");
    gpu::CollisionSettings settings{};
    const Contents slice = effects::triangle.slice.first(cooked_of(scene, fabric));
    std::memcpy(&settings, slice.bytes().data(), sizeof settings);
    const auto sums = passes.get<gpu::ivec4>(buffers::collision_sums, 2 * p.size());
    Asked asked;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double unit = sums[2 * i].w == 0 ? 0 : double(WEFT_WHOLE_WEIGHT) * settings.quantum / sums[2 * i].w;
      asked.out_of.push_back(unit * Vector(sums[2 * i].x, sums[2 * i].y, sums[2 * i].z));
      asked.friction.push_back(unit * Vector(sums[2 * i + 1].x, sums[2 * i + 1].y, sums[2 * i + 1].z));
    }
    return asked;
  }
};

reference::Corners corners(const std::vector<gpu::vec4>& p, std::size_t triangle) {
  return {vector(p[3 * triangle]), vector(p[3 * triangle + 1]), vector(p[3 * triangle + 2])};
}

// Ways out that are as short, or just met and just missed: rounding decides. The stir is longer than what the shader takes for
// a better axis.
bool is_undecided(const reference::Body& body, const reference::Corners& x, double tolerance) {
  const reference::Gap undisturbed = reference::gap_of(body, x);
  for (std::size_t k = 0; k < 18; ++k) {
    reference::Corners stirred = x;
    stirred[k / 6] += (k % 2 == 0 ? tolerance : -tolerance) / 4 * Vector::Unit(static_cast<int>(k / 2 % 3));
    const reference::Gap gap = reference::gap_of(body, stirred);
    if ((gap.normal - undisturbed.normal).norm() > 1e-3 || std::abs(gap.size - undisturbed.size) > tolerance / 2) return true;
  }
  return false;
}

void compare(const compute::Device& device, ColliderShape shape, double size, double speed, std::uint64_t seed, bool tapered = false) {
  Random random(seed);
  Trial trial(random, shape, size, speed, 0, 1200, tapered);
  const auto asked = trial.run(device, seed % 2 == 0);
  const reference::Body body = trial.body();
  const double separation = 0.9 * 0.002;
  const double tolerance = 1e-5;   // of distances of 1 m with half-metre triangles, whose normals amplify rounding
  int met = 0, left_out = 0;
  for (std::size_t t = 0; t < trial.fabric.triangles.size(); ++t) {
    const reference::Corners from = corners(trial.fabric.positions, t), to = corners(trial.p, t);
    SCOPED_TRACE("triangle " + std::to_string(t) + ", shape " + std::to_string(int(shape)) + ", seed " + std::to_string(seed));
    const std::array<Vector, 3> moved = {asked.out_of[3 * t], asked.out_of[3 * t + 1], asked.out_of[3 * t + 2]};
    const double all = moved[0].norm() + moved[1].norm() + moved[2].norm();
    bool has_anchor = false;
    for (int k = 0; k < 3; ++k) {
      const bool anchored = trial.fabric.positions[3 * t + k].w == 0;
      if (anchored) { EXPECT_EQ(moved[k].norm(), 0); }
      has_anchor |= anchored;
    }
    reference::Corners a, b;
    for (std::size_t k = 0; k < 3; ++k) {
      a[k] = body.own_before(from[k]);
      b[k] = body.own_after(to[k]);
    }
    const reference::Way way = reference::way_out(body, from, to, separation);
    if (way.gap.size > way.wanted + 0.01 && !way.is_back && all == 0) continue;
    const double turned = reference::gap_of(body, a).normal.dot(reference::gap_of(body, b).normal);
    if (std::abs(turned) < 1e-4 || is_undecided(body, a, tolerance) || is_undecided(body, b, tolerance)) {
      ++left_out;
      continue;
    }
    const Vector out = body.rotation_after * way.gap.normal;
    if (has_anchor) continue;   // no more is claimed of them than that anchors stay
    // Back from behind a box it is open which of its points is the nearest: with it goes whether it has to go, and how far.
    const bool is_open = way.is_back && shape == ColliderShape::box;
    if (is_open && all == 0) continue;
    if (!is_open && way.gap.size >= way.wanted) {
      EXPECT_EQ(all, 0);
      continue;
    }
    if (way.wanted - way.gap.size > 0.06 || all > 0.15) continue;   // further than triangles go in an iteration
    ++met;
    // Corner j moves by missing b_j / (sum b^2), so that b_j follows from how far it moves, and what is missing from all of them.
    Vector point = Vector::Zero();
    double missing = 0;
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((moved[k] - moved[k].dot(out) * out).norm(), tolerance);
      EXPECT_GE(moved[k].dot(out), 0);
      point += moved[k].norm() / all * to[k];
      missing += moved[k].squaredNorm() / all;
    }
    const double size = out.dot(point - body.centre_after) - reference::support_of(body, way.gap.normal);
    EXPECT_NEAR(missing, way.wanted - size, tolerance);
    if (!is_open) { EXPECT_NEAR(size, way.gap.size, 3e-4); }   // its nearest point; where corners are as near, between them
  }
  EXPECT_GT(met, 10) << "the scene tests nothing";
  EXPECT_LT(left_out, 120);
}

TEST_F(TriangleKernel, do_what_their_twin_does_with_spheres) {
  compare(device(), ColliderShape::sphere, 0.05, 0.02, 1);
  compare(device(), ColliderShape::sphere, 0.5, 0.02, 2);
  compare(device(), ColliderShape::sphere, 0.5, 0.5, 3);
}

TEST_F(TriangleKernel, do_what_their_twin_does_with_capsules) {
  compare(device(), ColliderShape::capsule, 0.05, 0.02, 4);
  compare(device(), ColliderShape::capsule, 0.5, 0.02, 5);
  compare(device(), ColliderShape::capsule, 0.5, 0.5, 6);
}

TEST_F(TriangleKernel, do_what_their_twin_does_with_capsules_of_two_radii) {
  compare(device(), ColliderShape::capsule, 0.05, 0.02, 41, true);
  compare(device(), ColliderShape::capsule, 0.5, 0.02, 42, true);
  compare(device(), ColliderShape::capsule, 0.5, 0.5, 53, true);
}

TEST_F(TriangleKernel, do_what_their_twin_does_with_boxes) {
  compare(device(), ColliderShape::box, 0.05, 0.02, 7);
  compare(device(), ColliderShape::box, 0.5, 0.02, 8);
  compare(device(), ColliderShape::box, 0.5, 0.5, 9);
}

// The mean of what its triangles ask for, made longer where they put it out in unlike directions.
TEST_F(TriangleKernel, move_a_particle_as_its_twin_does_whatever_directions_they_ask_for) {
  Random random(60);
  Trial trial(random, ColliderShape::sphere, 0.3, 0.02, 0, 240);
  trial.share_corners();
  SinglePass passes(device(), trial.scene, trial.fabric, false);
  passes.put_iterate(trial.p);
  FrameInput input = frame_of(1);
  input.colliders = std::span(&trial.collider, 1);
  passes.begin(input);
  for (const char* pass : {"triangle_search", "triangle_collide", "finalize"}) passes.run(pass);
  const auto moved = passes.iterate();
  const reference::Body body = trial.body();
  const double thickness = trial.fabric.materials[0].thickness;
  const reference::Points x = points(trial.fabric.positions), p = points(trial.p);
  const auto asked =
      reference::ask_triangles(std::span(&body, 1), trial.fabric.triangles, x, p, inverse_masses(trial.fabric), thickness);
  int longer = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (trial.p[i].w == 0) continue;
    const Vector twin = reference::out_of_body(body, x[i] + asked[i].out_of, p[i] + asked[i].out_of, thickness);
    // Which point of a triangle is nearest is known to 3e-4 m (compare), and by that who of its corners moves how far.
    EXPECT_LT((vector(moved[i]) - twin).norm(), 1e-4) << "particle " << i << ", " << asked[i].longer << " times the mean";
    longer += asked[i].longer > 1.2 && (1 - 1 / asked[i].longer) * asked[i].out_of.norm() > 1e-3;
  }
  EXPECT_GT(longer, 5) << "the scene tests nothing";
}

// Coulomb, of every corner: as much of its slip as friction times how far it is put out, and no more than all of it.
TEST_F(TriangleKernel, rub_by_coulombs_law) {
  for (const ColliderShape shape : {ColliderShape::sphere, ColliderShape::capsule, ColliderShape::box}) {
    Random random(20 + static_cast<std::uint64_t>(shape));
    Trial trial(random, shape, 0.3, 0.05, 0.5);
    const auto asked = trial.run(device(), false);
    const reference::Body body = trial.body();
    int sliding = 0, stuck = 0;
    for (std::size_t i = 0; i < trial.p.size(); ++i) {
      const double depth = asked.out_of[i].norm();
      if (depth < 1e-3) continue;   // too short to tell the normal from
      const Vector normal = asked.out_of[i] / depth;
      const Vector a = body.own_before(vector(trial.fabric.positions[i])), b = body.own_after(vector(trial.p[i]));
      const Vector motion = body.rotation_after * (b - a), slip = motion - motion.dot(normal) * normal;
      const double most = body.friction * depth;
      EXPECT_LT((asked.friction[i] + std::min(1.0, most / slip.norm()) * slip).norm(), 1e-4) << "particle " << i;
      ++(most < slip.norm() ? sliding : stuck);
    }
    EXPECT_GT(sliding, 10);
    EXPECT_GT(stuck, 5);
  }
}

// The sums that particles take their means from are whole numbers: the order in which threads list triangles and add does not matter.
TEST_F(TriangleKernel, ask_for_the_same_to_the_bit_whatever_the_order) {
  Random random(30);
  Trial trial(random, ColliderShape::box, 0.3, 0.05, 0.5);
  const auto once = trial.run(device(), false), again = trial.run(device(), true);
  for (std::size_t i = 0; i < trial.p.size(); ++i) {
    ASSERT_EQ(once.out_of[i], again.out_of[i]);
    ASSERT_EQ(once.friction[i], again.friction[i]);
  }
}

}  // namespace
}  // namespace weft
