// The twins (shaders/*.ref.h) against what they must be by themselves: finite differences of their energies, conserved
// momentum, the friction cone. Bending is in tests/effects/bend/twin_test.cpp; the shaders are tested against the twins in kernel_test.cpp.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/mesh.h"
#include "shaders/anchor/anchor.ref.h"
#include "shaders/collide/collide.ref.h"
#include "shaders/motion/motion.ref.h"
#include "shaders/stretch/stretch.ref.h"
#include "shaders/surface/surface.ref.h"
#include "shaders/tether/tether.ref.h"
#include "tests/support/twins.h"

namespace weft::reference {
namespace {

TEST(StretchTwin, its_gradient_is_the_slope_of_its_value) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Stretch link{0, 1, between(random, 0.1, 2), 1, false};
    const Vector a = anywhere(random, 1), b = a + anywhere(random, 1).normalized() * between(random, 0.2, 2);
    const Vector gradient = stretch_gradient(a, b);
    EXPECT_LT((difference([&](const Vector& p) { return stretch_value(link, p, b); }, a) - gradient).norm(), kDifferenceTolerance);
    EXPECT_LT((difference([&](const Vector& p) { return stretch_value(link, a, p); }, b) + gradient).norm(), kDifferenceTolerance);
  }
}

TEST(StretchTwin, its_energy_falls_along_value_over_compliance_times_gradient) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Stretch link{0, 1, between(random, 0.5, 1.5), between(random, 0.5, 2), trial % 2 == 1};
    const Vector a = anywhere(random, 1), b = a + anywhere(random, 1).normalized() * between(random, 0.2, 2);
    const double c = stretch_value(link, a, b);
    const Vector force = link.only_pulls && c < 0 ? Vector(Vector::Zero()) : Vector(c / link.compliance * stretch_gradient(a, b));
    EXPECT_LT((difference([&](const Vector& p) { return stretch_energy(link, p, b); }, a) - force).norm(), 10 * kDifferenceTolerance);
  }
}

// A mesh of random links between particles of masses over three decades.
struct Tangle {
  std::vector<Stretch> links;
  Points positions;
  std::vector<double> inverse_masses;
};

Tangle tangle(Random& random, std::uint32_t particles, std::size_t links) {
  Tangle t;
  for (std::uint32_t i = 0; i < particles; ++i) {
    t.positions.push_back(anywhere(random, 1));
    t.inverse_masses.push_back(std::pow(10, between(random, 0, 3)));
  }
  while (t.links.size() < links) {
    const auto a = static_cast<std::uint32_t>(random() % particles), b = static_cast<std::uint32_t>(random() % particles);
    const double rest = between(random, 0.1, 1), compliance = t.links.size() % 3 == 0 ? 0 : between(random, 0, 1e-3);
    if (a != b) t.links.push_back({a, b, rest, compliance, t.links.size() % 5 == 0});
  }
  return t;
}

// |sum m dp| after three iterations, relative to sum m |dp|.
double momentum_drift(const Tangle& t, Averaged averaging) {
  Points p = t.positions;
  std::vector<double> lambda(t.links.size());
  std::uint32_t skipped = 0;
  for (int k = 0; k < 3; ++k) p = relax_stretch(t.links, p, t.inverse_masses, lambda, 1e-3, 1, averaging, skipped);
  Vector sum = Vector::Zero();
  double size = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    sum += (p[i] - t.positions[i]) / t.inverse_masses[i];
    size += (p[i] - t.positions[i]).norm() / t.inverse_masses[i];
  }
  return sum.norm() / size;
}

TEST(StretchTwin, split_masses_conserve_momentum) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) EXPECT_LT(momentum_drift(tangle(random, 60, 240), Averaged::mass_split), 1e-12);
}

// Failure F5 of the earlier systems, shown on the same tangles.
TEST(StretchTwin, count_averaging_does_not_conserve_momentum) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) EXPECT_GT(momentum_drift(tangle(random, 60, 240), Averaged::count), 1e-3);
}

TEST(StretchTwin, a_lone_rigid_link_is_exact_after_one_iteration) {
  const std::vector<Stretch> links{{0, 1, 0.5, 0, false}};
  const Points p{{0, 0, 0}, {0.9, 0, 0}};
  const std::vector<double> w{1, 3};
  std::vector<double> lambda(1);
  std::uint32_t skipped = 0;
  const Points q = relax_stretch(links, p, w, lambda, 1e-3, 1, Averaged::mass_split, skipped);
  EXPECT_NEAR((q[0] - q[1]).norm(), 0.5, 1e-15);
  EXPECT_NEAR(q[0].x(), 0.1, 1e-15);   // a quarter of 0.4 by inverse mass
}

// Many iterations of a soft link between held and free end reach the minimum of |p - y|^2 / (2 w h^2) + C^2 / (2 alpha):
// C = (y - L) / (1 + w h^2 / alpha).
TEST(StretchTwin, a_soft_link_converges_to_implicit_euler) {
  const double h = 1e-2, alpha = 2e-5, w = 3, y = 1.5, rest = 1;
  const std::vector<Stretch> links{{0, 1, rest, alpha, false}};
  Points p{{0, 0, 0}, {y, 0, 0}};
  const std::vector<double> masses{0, w};
  std::vector<double> lambda(1);
  std::uint32_t skipped = 0;
  for (int k = 0; k < 10; ++k) p = relax_stretch(links, p, masses, lambda, h, 1, Averaged::mass_split, skipped);
  EXPECT_NEAR(p[1].x() - rest, (y - rest) / (1 + w * h * h / alpha), 1e-14);
}

TEST(StretchTwin, links_that_only_pull_leave_slack_alone_and_coincident_ends_are_pushed_apart) {
  const std::vector<Stretch> links{{0, 1, 2, 0, true}, {2, 3, 1, 0, false}};
  const Points p{{0, 0, 0}, {1, 0, 0}, {5, 5, 5}, {5, 5, 5}};
  const std::vector<double> w{1, 1, 1, 1};
  std::vector<double> lambda(2);
  std::uint32_t skipped = 0;
  const Points q = relax_stretch(links, p, w, lambda, 1e-3, 1, Averaged::mass_split, skipped);
  EXPECT_EQ(skipped, 1u);
  for (const std::size_t i : {0u, 1u}) EXPECT_EQ(q[i], p[i]);
  EXPECT_LT((q[2] - p[2] - 0.5 * apart()).norm(), 1e-15);
  EXPECT_LT((q[3] - p[3] + 0.5 * apart()).norm(), 1e-15);
}

TEST(TetherTwin, it_is_one_sided_exact_and_its_gradient_is_the_slope_of_its_value) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const Tether tether{anywhere(random, 1), between(random, 0.1, 2)};
    const Vector p = tether.anchor + anywhere(random, 1).normalized() * between(random, 0.2, 3);
    const Vector slope = difference([&](const Vector& q) { return tether_value(tether, q); }, p);
    EXPECT_LT((slope - tether_gradient(tether, p)).norm(), kDifferenceTolerance);
    const Vector held = within_tether(tether, p);
    if (tether_value(tether, p) <= 0) {
      EXPECT_EQ(held, p);
    } else {
      EXPECT_NEAR(tether_value(tether, held), 0, 1e-14);
      EXPECT_LT((held - p).cross(tether_gradient(tether, p)).norm(), 1e-14);   // straight towards the anchor
    }
  }
}

Body ball(double radius, double friction) {
  return {.shape = Shape::sphere, .radius = radius, .friction = friction};
}
Body capsule_of(double half_length, double radius) {
  Body body{.shape = Shape::capsule, .radius = radius, .half_size = Vector(0, half_length, 0)};
  body.rotation_before = body.rotation_after = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
  return body;
}
// Its radius is less by `taper` at the end along y.
Body tapered_of(double half_length, double radius, double taper) {
  Body body = capsule_of(half_length, radius);
  body.taper = taper;
  return body;
}
Body box_of(const Vector& half_size) {
  Body body{.shape = Shape::box, .half_size = half_size};
  body.rotation_before = body.rotation_after = Eigen::Quaterniond(0.6, 0.1, -0.4, 0.5).normalized();
  return body;
}
Body floor_at(double height, double friction) {
  return {.shape = Shape::plane, .centre_before = Vector(0, height, 0), .centre_after = Vector(0, height, 0), .friction = friction};
}

TEST(ColliderTwin, the_gradient_is_the_slope_of_the_distance) {
  Random random(8);
  for (int trial = 0; trial < 100; ++trial)
    for (Body body : {ball(0.5, 0), floor_at(0.2, 0), capsule_of(0.4, 0.15), box_of({0.5, 0.4, 0.3}), tapered_of(0.4, 0.15, 0.1),
                      tapered_of(0.2, 0.1, -0.3)}) {
      body.normal_after = anywhere(random, 1).normalized();
      const Vector p = anywhere(random, 1).normalized() * between(random, 0.2, 2);
      const Vector slope = difference([&](const Vector& q) { return signed_distance(body, q); }, p);
      EXPECT_LT((slope - distance_gradient(body, p)).norm(), kDifferenceTolerance);
    }
}

TEST(ColliderTwin, whoever_is_inside_comes_out_by_the_shortest_way_and_whoever_is_outside_stays) {
  Random random(9);
  for (int trial = 0; trial < 500; ++trial)
    for (const Body& body : {ball(0.5, 0), floor_at(0.2, 0), capsule_of(0.4, 0.3), box_of({0.5, 0.4, 0.3}), tapered_of(0.4, 0.1, -0.3),
                             tapered_of(0.4, 0.4, 0.1), tapered_of(0.1, 0.4, 0.2), tapered_of(0.1, 0.1, -0.35)}) {
      const Vector p = anywhere(random, 1), x = p;
      const Vector q = out_of_body(body, x, p, 0.01);
      const double before = signed_distance(body, p);
      EXPECT_NEAR(signed_distance(body, q), std::max(before, 0.01), 1e-14);
      EXPECT_NEAR((q - p).norm(), std::max(0.01 - before, 0.0), 1e-14);
    }
  EXPECT_EQ(out_of_body(ball(0.5, 0), Vector::Zero(), Vector::Zero(), 0), Vector(0, 0.5, 0));
}

// The spheres along the core, each as large as the two ends have it there.
TEST(ColliderTwin, a_capsule_with_two_radii_is_as_far_as_the_nearest_of_its_spheres) {
  Random random(10);
  for (const Body& body : {tapered_of(0.4, 0.3, 0.2), tapered_of(0.4, 0.05, -0.6), tapered_of(0.1, 0.4, 0.2), tapered_of(0.1, 0.1, -0.3)})
    for (int trial = 0; trial < 200; ++trial) {
      const Vector p = anywhere(random, 1);
      double least = 1e9;
      for (int k = 0; k <= 4000; ++k) {
        const double t = k / 4000.0;
        const Vector centre(0, (2 * t - 1) * body.half_size.y(), 0);
        least = std::min(least, (p - centre).norm() - (body.radius - t * body.taper));
      }
      EXPECT_NEAR(own_distance(body, p), least, 1e-6);
      EXPECT_LE(own_distance(body, p), least + 1e-12);
    }
}

TEST(ColliderTwin, a_point_that_a_fast_sphere_ran_over_is_caught_on_the_way) {
  Body body = ball(0.1, 0);
  body.centre_before = {-3, 0, 0};
  body.centre_after = {3, 0, 0};
  const Vector p(0.2, 0.05, 0);
  const Vector q = out_of_body(body, p, p, 0);
  EXPECT_NEAR(signed_distance(body, q), 0, 1e-12);
  EXPECT_EQ(out_of_body(body, Vector(0, 0.2, 0), Vector(0, 0.2, 0), 0), Vector(0, 0.2, 0));   // beside its way
}

TEST(ColliderTwin, a_thin_box_that_ran_past_holds_the_point_before_the_face_that_met_it) {
  Body body{.shape = Shape::box, .half_size = Vector(0.01, 1, 1)};
  body.centre_before = {-3, 0, 0};
  body.centre_after = {2, 0, 0};
  const Vector p(0.2, 0.05, 0), q = out_of_body(body, p, p, 0.002);
  EXPECT_LT((q - Vector(2.012, 0.05, 0)).norm(), 1e-9);
  EXPECT_EQ(out_of_body(body, Vector(0.2, 1.1, 0), Vector(0.2, 1.1, 0), 0.002), Vector(0.2, 1.1, 0));   // beside its way
}

TEST(ColliderTwin, a_point_that_ends_nearer_the_far_face_goes_back_the_way_it_came) {
  const Body box{.shape = Shape::box, .half_size = Vector(1, 0.1, 1)};
  EXPECT_LT((out_of_body(box, Vector(0, 0.2, 0), Vector(0.3, -0.05, 0), 0) - Vector(0.3, 0.1, 0)).norm(), 1e-9);
  EXPECT_LT((out_of_body(box, Vector(0, 0, 0), Vector(0.3, -0.05, 0), 0) - Vector(0.3, -0.1, 0)).norm(), 1e-9);   // began inside
}

TEST(ColliderTwin, what_sticks_to_a_turning_box_turns_with_it) {
  Body body{.shape = Shape::box, .half_size = Vector(1, 1, 1), .friction = 1e3};
  body.rotation_after = Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector::UnitY()));
  const Vector x(1, 0.2, 0.1), there = body.rotation_after * x;
  EXPECT_LT((out_of_body(body, x, there - 0.01 * (body.rotation_after * Vector::UnitX()), 0) - there).norm(), 1e-12);
}

TEST(ColliderTwin, friction_stays_in_its_cone_and_sticks_inside_it) {
  Random random(10);
  for (int trial = 0; trial < 500; ++trial) {
    const double mu = between(random, 0, 1.5);
    const Body body = floor_at(0, mu);
    const Vector x(between(random, -1, 1), 0, between(random, -1, 1));
    const Vector p = x + Vector(between(random, -0.1, 0.1), -between(random, 0, 0.1), between(random, -0.1, 0.1));
    const Vector q = out_of_body(body, x, p, 0);
    const double normal = -p.y(), wanted = std::hypot(p.x() - x.x(), p.z() - x.z());
    const double taken_back = std::hypot(q.x() - p.x(), q.z() - p.z()), left = std::hypot(q.x() - x.x(), q.z() - x.z());
    EXPECT_LE(taken_back, mu * normal + 1e-15);
    EXPECT_NEAR(left, std::max(wanted - mu * normal, 0.0), 1e-14);
  }
}

TEST(ColliderTwin, a_turning_sphere_carries_what_sticks_to_it) {
  Body body = ball(1, 1e3);
  body.turn = {0, 0.01, 0};
  const Vector x(1, 0, 0);
  const Vector q = out_of_body(body, x, Vector(0.99, 0, 0), 0);
  EXPECT_LT((q - (x + body.turn.cross(x))).norm(), 1e-12);
}

TEST(MotionTwin, damped_fall_follows_its_closed_form_as_the_step_shrinks) {
  const Vector gravity(0, -9.81, 0);
  const double damping = 0.5;
  const auto fallen = [&](int steps) {
    Motion now{Vector::Zero(), Vector(1, 0, 0)};
    for (int k = 0; k < steps; ++k) now = predict(now, gravity, damping, 1.0 / steps, false);
    return now;
  };
  const double damping_factor = std::exp(-damping);
  const Motion fine = fallen(4000);
  EXPECT_NEAR(fine.velocity.y(), -9.81 / damping * (1 - damping_factor), 2e-3);   // first order: 9.81 / 4000
  EXPECT_NEAR(fine.velocity.x(), damping_factor, 1e-12);
  EXPECT_NEAR(fine.position.x(), (1 - damping_factor) / damping, 1e-4);
  EXPECT_EQ(predict({Vector(1, 2, 3), Vector(4, 5, 6)}, gravity, damping, 0.1, true).position, Vector(1, 2, 3));
  EXPECT_LT((velocity(Vector(1, 0, 0), Vector(1.5, 0, 0), 0.25) - Vector(2, 0, 0)).norm(), 1e-15);
}

TEST(AnchorTwin, it_starts_and_ends_where_it_is_told) {
  const Vector from(1, 2, 3), to(4, 5, -6);
  EXPECT_EQ(anchor_at(from, to, 0), from);
  EXPECT_EQ(anchor_at(from, to, 1), to);
  EXPECT_LT((anchor_at(from, to, 0.25) - Vector(1.75, 2.75, 0.75)).norm(), 1e-15);
}

TEST(AnchorTwin, it_reduces_its_tracking_error_gradually_up_to_the_kinematic_lag_limit) {
  const Vector x(1, 2, 3), target = x + Vector(0, 0.3, -0.4);
  EXPECT_LT((anchor_after(target, x, 0.1, 0.4, 0.05, 0.1, 10) - (x + Vector(0, 0.09, -0.12))).norm(), 1e-15);
  EXPECT_EQ(anchor_after(target, x, 0.5, 0.4, 0.05, 0.1, 10), target);
  EXPECT_EQ(anchor_after(target, x, 0.1, 0.4, 0.05, 0.1, 3), target);
  EXPECT_EQ(anchor_after(x, x, 0, 0, 0, 1, 1), x);
  EXPECT_LT((anchor_after(target, x, 0, 0.5, 0, 0.1, 6) - (x + 0.016 * Vector(0, 0.3, -0.4))).norm(), 1e-15) << "where nothing recovers, too";
}

TEST(SurfaceTwin, normals_of_a_sphere_point_outwards) {
  const Mesh grid = make_grid({.size = {1, 1}, .cells_x = 24, .cells_y = 24});
  Points x;
  for (const Vec3 p : grid.points) x.push_back(Vector(p.x, 2, p.z).normalized());
  const Points normals = point_normals(x, grid.triangles);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_GT(normals[i].dot(x[i]), 0.999);   // rims see one side only
  EXPECT_EQ(point_normals({Vector::Zero()}, {}).front(), Vector::UnitY());
}

}  // namespace
}  // namespace weft::reference
