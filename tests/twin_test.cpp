// The twins (shaders/*.ref.h) against what they must be by themselves: finite differences of their energies, conserved
// momentum, poses of known energy. The shaders are tested against the twins in kernel_test.cpp. Double precision, no GPU.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "engine/fabric.h"
#include "engine/mesh.h"
#include "shaders/anchor.ref.h"
#include "shaders/bend.ref.h"
#include "shaders/collide.ref.h"
#include "shaders/motion.ref.h"
#include "shaders/stretch.ref.h"
#include "shaders/surface.ref.h"
#include "shaders/tether.ref.h"

namespace weft::reference {
namespace {

using Random = std::mt19937_64;

double between(Random& random, double low, double high) { return std::uniform_real_distribution(low, high)(random); }
Vector anywhere(Random& random, double size) { return {between(random, -size, size), between(random, -size, size), between(random, -size, size)}; }

// Central differences: error of order step^2 |f'''| and eps |f| / step; 1e-5 balances them for values near 1.
constexpr double kStep = 1e-5;
constexpr double kDifferenceTolerance = 1e-8;

Vector difference(const std::function<double(const Vector&)>& value, const Vector& at) {
  Vector gradient;
  for (int k = 0; k < 3; ++k) gradient[k] = (value(at + kStep * Vector::Unit(k)) - value(at - kStep * Vector::Unit(k))) / (2 * kStep);
  return gradient;
}

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

Tangle tangle(Random& random, int particles, int links, bool held) {
  Tangle t;
  for (int i = 0; i < particles; ++i) {
    t.positions.push_back(anywhere(random, 1));
    t.inverse_masses.push_back(held && i % 7 == 0 ? 0 : std::pow(10, between(random, 0, 3)));
  }
  while (static_cast<int>(t.links.size()) < links) {
    const auto a = static_cast<std::uint32_t>(random() % static_cast<unsigned>(particles)), b = static_cast<std::uint32_t>(random() % static_cast<unsigned>(particles));
    if (a != b) t.links.push_back({a, b, between(random, 0.1, 1), t.links.size() % 3 == 0 ? 0 : between(random, 0, 1e-3), t.links.size() % 5 == 0});
  }
  return t;
}

// |sum m dp| after three iterations, relative to sum m |dp|.
double momentum_drift(const Tangle& t, Meeting meeting) {
  Points p = t.positions;
  std::vector<double> lambda(t.links.size());
  std::uint32_t skipped = 0;
  for (int k = 0; k < 3; ++k) p = relax_stretch(t.links, p, t.inverse_masses, lambda, 1e-3, 1, meeting, skipped);
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
  for (int trial = 0; trial < 20; ++trial) EXPECT_LT(momentum_drift(tangle(random, 60, 240, false), Meeting::mass_split), 1e-12);
}

// Failure F5 of the earlier systems, shown on the same tangles.
TEST(StretchTwin, count_averaging_does_not_conserve_momentum) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) EXPECT_GT(momentum_drift(tangle(random, 60, 240, false), Meeting::count), 1e-3);
}

TEST(StretchTwin, a_lone_rigid_link_is_exact_after_one_iteration) {
  const std::vector<Stretch> links{{0, 1, 0.5, 0, false}};
  const Points p{{0, 0, 0}, {0.9, 0, 0}};
  const std::vector<double> w{1, 3};
  std::vector<double> lambda(1);
  std::uint32_t skipped = 0;
  const Points q = relax_stretch(links, p, w, lambda, 1e-3, 1, Meeting::mass_split, skipped);
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
  for (int k = 0; k < 10; ++k) p = relax_stretch(links, p, masses, lambda, h, 1, Meeting::mass_split, skipped);
  EXPECT_NEAR(p[1].x() - rest, (y - rest) / (1 + w * h * h / alpha), 1e-14);
}

TEST(StretchTwin, links_that_only_pull_leave_slack_alone_and_coincident_ends_are_counted) {
  const std::vector<Stretch> links{{0, 1, 2, 0, true}, {2, 3, 1, 0, false}};
  const Points p{{0, 0, 0}, {1, 0, 0}, {5, 5, 5}, {5, 5, 5}};
  const std::vector<double> w{1, 1, 1, 1};
  std::vector<double> lambda(2);
  std::uint32_t skipped = 0;
  const Points q = relax_stretch(links, p, w, lambda, 1e-3, 1, Meeting::mass_split, skipped);
  EXPECT_EQ(skipped, 1u);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(q[static_cast<std::size_t>(i)], p[static_cast<std::size_t>(i)]);
}

// Two triangles in one plane, angles at x0 and x1 between 20 and 120 degrees.
Stencil flat_stencil(Random& random) {
  const double length = between(random, 0.5, 2);
  Stencil x{Vector(0, 0, 0), Vector(length, 0, 0), Vector::Zero(), Vector::Zero()};
  x[2] = Vector(between(random, 0.1, 0.9) * length, between(random, 0.3, 1) * length, 0);
  x[3] = Vector(between(random, 0.1, 0.9) * length, -between(random, 0.3, 1) * length, 0);
  return x;
}

TEST(BendTwin, it_annihilates_every_affine_map_of_a_flat_stencil) {
  Random random(4);
  for (int trial = 0; trial < 500; ++trial) {
    Stencil x = flat_stencil(random);
    const BendStencil stencil = bend_stencil(x);
    EXPECT_NEAR(stencil.k.sum(), 0, 1e-13 * stencil.k.norm());
    Eigen::Matrix3d map;
    for (int k = 0; k < 3; ++k) map.col(k) = anywhere(random, 3);
    const Vector shift = anywhere(random, 10);
    for (Vector& p : x) p = map * p + shift;
    EXPECT_LT(bend_value(stencil.k, x).norm(), 1e-12 * stencil.k.norm() * 20);   // 20: size of the mapped pose
  }
}

TEST(BendTwin, its_gradient_is_the_slope_of_its_energy) {
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const BendStencil stencil = bend_stencil(flat_stencil(random));
    Stencil p;
    for (Vector& v : p) v = anywhere(random, 1);
    const Stencil gradient = bend_energy_gradient(stencil, 0.3, p);
    for (std::size_t j = 0; j < 4; ++j) {
      const Vector slope = difference([&](const Vector& moved) { Stencil q = p; q[j] = moved; return bend_energy(stencil, 0.3, q); }, p[j]);
      EXPECT_LT((slope - gradient[j]).norm(), 1e-8 * (1 + gradient[j].norm()));
    }
  }
}

TEST(BendTwin, split_masses_conserve_momentum_and_plain_counts_do_not) {
  Random random(6);
  const Mesh mesh = make_grid({.size = {1, 1}, .cells_x = 8, .cells_y = 8, .topology = Topology::centre});
  Points p;
  std::vector<double> w;
  for (const Vec3 x : mesh.points) {
    p.push_back(Vector(x.x, x.y, x.z) + anywhere(random, 0.02));
    w.push_back(between(random, 1, 100));
  }
  std::vector<Bend> bends;
  for (const WingedEdge& edge : mesh.edges) {
    if (edge.triangle[1] == kNone) continue;
    Bend bend{{edge.a, edge.b, edge.across[0], edge.across[1]}, {}, 0};
    Stencil x;
    for (std::size_t j = 0; j < 4; ++j) x[j] = Vector(mesh.points[bend.particle[j]].x, mesh.points[bend.particle[j]].y, mesh.points[bend.particle[j]].z);
    bend.k = bend_stencil(x).k;
    bend.compliance = 1 / (0.1 * bend_stencil(x).q);   // stiff, so that rounding of positions is small against the motion
    bends.push_back(bend);
  }
  const auto drift = [&](Meeting meeting) {
    std::vector<Vector> lambda(bends.size(), Vector::Zero());
    const Points q = relax_bend(bends, p, w, lambda, 1.0 / 720, 1, meeting);
    Vector sum = Vector::Zero();
    double size = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += (q[i] - p[i]) / w[i], size += (q[i] - p[i]).norm() / w[i];
    return sum.norm() / size;
  };
  EXPECT_LT(drift(Meeting::mass_split), 1e-12);
  EXPECT_GT(drift(Meeting::count), 1e-4);
}

// A sheet rolled into a cylinder of curvature k has 1/2 B k^2 a unit of area. Edges at the sheet's rims have no stencil, so it
// is measured per area of the inner ones: of its triangles each edge has a third. Returns measured over expected.
double cylinder_energy_ratio(const Mesh& mesh, double degrees) {
  const double curvature = 2, rigidity = 1e-4, angle = degrees * std::numbers::pi / 180;
  const Vector along(std::cos(angle), 0, std::sin(angle)), across(-std::sin(angle), 0, std::cos(angle));
  const auto flat = [&](std::uint32_t i) { return Vector(mesh.points[i].x, 0, mesh.points[i].z); };
  const auto rolled = [&](const Vector& x) {
    const double turn = curvature * x.dot(along);
    return Vector(std::sin(turn) / curvature * along + x.dot(across) * across + (1 - std::cos(turn)) / curvature * Vector::UnitY());
  };
  double energy = 0, area = 0;
  for (const WingedEdge& edge : mesh.edges) {
    if (edge.triangle[1] == kNone) continue;
    const Stencil x{flat(edge.a), flat(edge.b), flat(edge.across[0]), flat(edge.across[1])};
    const BendStencil stencil = bend_stencil(x);
    energy += bend_energy(stencil, rigidity, {rolled(x[0]), rolled(x[1]), rolled(x[2]), rolled(x[3])});
    area += ((x[1] - x[0]).cross(x[2] - x[0]).norm() + (x[1] - x[0]).cross(x[3] - x[0]).norm()) / 6;
  }
  return energy / (0.5 * rigidity * curvature * curvature * area);
}

// Squares with one diagonal, sheared into equilateral triangles: sides (1, 0) and (1/2, sqrt(3)/2) and their difference.
Mesh equilateral(std::uint32_t cells) {
  Mesh mesh = make_grid({.size = {1, 1}, .cells_x = cells, .cells_y = cells});
  // The shear that makes the diagonal as short as the sides; the other one makes it sqrt(3) sides long.
  for (const float lean : {0.5f, -0.5f}) {
    Mesh leaning = mesh;
    for (Vec3& p : leaning.points) p = {p.x + lean * p.z, 0, std::sqrt(0.75f) * p.z};
    float longest = 0;
    for (const WingedEdge& edge : leaning.edges) longest = std::max(longest, length(leaning.points[edge.a] - leaning.points[edge.b]));
    if (longest < 1.1f / static_cast<float>(cells)) return leaning;
  }
  return mesh;
}

TEST(BendTwin, equilateral_triangles_rolled_in_any_direction_have_half_rigidity_times_curvature_squared_times_area) {
  for (const double degrees : {0.0, 10.0, 20.0, 30.0, 45.0, 77.0, 90.0}) {
    // Second order in the size of the triangles, (k / 64)^2 = 1e-3; the kinds of edges are not equally many along the rims, 2 / 64.
    EXPECT_NEAR(cylinder_energy_ratio(equilateral(64), degrees), 1, 0.03) << degrees;
  }
}

TEST(BendTwin, squares_with_a_diagonal_are_exact_along_a_side_and_within_their_known_range_elsewhere) {
  const Mesh squares = make_grid({.size = {1, 1}, .cells_x = 64, .cells_y = 64});
  EXPECT_NEAR(cylinder_energy_ratio(squares, 0), 1, 0.03);
  EXPECT_NEAR(cylinder_energy_ratio(squares, 90), 1, 0.03);
  // Per area 1 + u + u^2 with u = sin(2 angle), by hand from the quadratic form of one cell.
  for (const double degrees : {-45.0, -15.0, 15.0, 45.0}) {
    const double ratio = cylinder_energy_ratio(squares, degrees), u = std::sin(degrees * std::numbers::pi / 90);
    EXPECT_TRUE(std::abs(ratio - (1 + u + u * u)) < 0.05 || std::abs(ratio - (1 - u + u * u)) < 0.05) << degrees << " degrees: " << ratio;
  }
  const Mesh centres = make_grid({.size = {1, 1}, .cells_x = 64, .cells_y = 64, .topology = Topology::centre});
  for (const double degrees : {0.0, 20.0, 45.0}) {
    const double ratio = cylinder_energy_ratio(centres, degrees);
    EXPECT_GT(ratio, 0.9) << degrees;
    EXPECT_LT(ratio, 1.55) << degrees;
  }
}

TEST(BendTwin, cooking_makes_the_same_stencils) {
  Random random(11);
  Scene scene;
  scene.cloths.emplace_back().grid = Grid{{1, 1}, 9, 7, Topology::centre, false};
  scene.cloths[0].fabric.bend = 3e-5;
  auto meshes = make_meshes(scene);
  ASSERT_TRUE(meshes);
  for (Vec3& p : (*meshes)[0].points) p = p + Vec3{static_cast<float>(between(random, -0.01, 0.01)), 0, static_cast<float>(between(random, -0.01, 0.01))};
  const auto fabric = cook(scene, *meshes);
  ASSERT_TRUE(fabric);
  ASSERT_GT(fabric->bends.size(), 200u);
  for (const gpu::Bend& bend : fabric->bends) {
    Stencil x;
    for (std::size_t j = 0; j < 4; ++j) {
      const gpu::vec4& p = fabric->positions[bend.particle[j]];
      x[j] = {p.x, p.y, p.z};
    }
    const BendStencil wanted = bend_stencil(x);
    EXPECT_LT((Eigen::Vector4d(bend.k[0], bend.k[1], bend.k[2], bend.k[3]) - wanted.k).norm(), 1e-7 * wanted.k.norm());   // stored as floats
    EXPECT_NEAR(bend.compliance * 3e-5 * wanted.q, 1, 1e-7);
  }
}

TEST(TetherTwin, it_is_one_sided_exact_and_its_gradient_is_the_slope_of_its_value) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const Tether tether{anywhere(random, 1), between(random, 0.1, 2)};
    const Vector p = tether.anchor + anywhere(random, 1).normalized() * between(random, 0.2, 3);
    EXPECT_LT((difference([&](const Vector& q) { return tether_value(tether, q); }, p) - tether_gradient(tether, p)).norm(), kDifferenceTolerance);
    const Vector held = within_tether(tether, p);
    if (tether_value(tether, p) <= 0) {
      EXPECT_EQ(held, p);
    } else {
      EXPECT_NEAR(tether_value(tether, held), 0, 1e-14);
      EXPECT_LT((held - p).cross(tether_gradient(tether, p)).norm(), 1e-14);   // straight towards the anchor
    }
  }
}

Body ball(double radius, double friction) { return {Vector::Zero(), Vector::Zero(), Vector::UnitY(), Vector::UnitY(), radius, Vector::Zero(), friction}; }
Body floor_at(double height, double friction) {
  return {Vector(0, height, 0), Vector(0, height, 0), Vector::UnitY(), Vector::UnitY(), -1, Vector::Zero(), friction};
}

TEST(ColliderTwin, the_gradient_is_the_slope_of_the_distance) {
  Random random(8);
  for (int trial = 0; trial < 100; ++trial)
    for (Body body : {ball(0.5, 0), floor_at(0.2, 0)}) {
      body.normal_after = anywhere(random, 1).normalized();
      const Vector p = anywhere(random, 1).normalized() * between(random, 0.2, 2);
      EXPECT_LT((difference([&](const Vector& q) { return signed_distance(body, q); }, p) - distance_gradient(body, p)).norm(), kDifferenceTolerance);
    }
}

TEST(ColliderTwin, whoever_is_inside_comes_out_by_the_shortest_way_and_whoever_is_outside_stays) {
  Random random(9);
  for (int trial = 0; trial < 500; ++trial)
    for (const Body& body : {ball(0.5, 0), floor_at(0.2, 0)}) {
      const Vector p = anywhere(random, 1), x = p;
      const Vector q = out_of_body(body, x, p, 0.01);
      const double before = signed_distance(body, p);
      EXPECT_NEAR(signed_distance(body, q), std::max(before, 0.01), 1e-14);
      EXPECT_NEAR((q - p).norm(), std::max(0.01 - before, 0.0), 1e-14);
    }
  EXPECT_EQ(out_of_body(ball(0.5, 0), Vector::Zero(), Vector::Zero(), 0), Vector(0, 0.5, 0));
}

TEST(ColliderTwin, a_point_that_a_fast_sphere_ran_over_is_caught_on_the_way) {
  Body body = ball(0.1, 0);
  body.centre_before = {-3, 0, 0};
  body.centre_after = {3, 0, 0};
  const Vector p(0.2, 0.05, 0);
  const Vector q = out_of_body(body, p, p, 0);
  EXPECT_NEAR(signed_distance(body, q), 0, 1e-12);
  EXPECT_EQ(out_of_body(body, Vector(0, 0.2, 0), Vector(0, 0.2, 0), 0), Vector(0, 0.2, 0));   // beside its path
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
  const double kept = std::exp(-damping);
  const Motion fine = fallen(4000);
  EXPECT_NEAR(fine.velocity.y(), -9.81 / damping * (1 - kept), 2e-3);   // first order: 9.81 / 4000
  EXPECT_NEAR(fine.velocity.x(), kept, 1e-12);
  EXPECT_NEAR(fine.position.x(), (1 - kept) / damping, 1e-4);
  EXPECT_EQ(predict({Vector(1, 2, 3), Vector(4, 5, 6)}, gravity, damping, 0.1, true).position, Vector(1, 2, 3));
  EXPECT_LT((velocity(Vector(1, 0, 0), Vector(1.5, 0, 0), 0.25) - Vector(2, 0, 0)).norm(), 1e-15);
}

TEST(AnchorTwin, it_starts_and_ends_where_it_is_told) {
  const Vector from(1, 2, 3), to(4, 5, -6);
  EXPECT_EQ(anchor_at(from, to, 0), from);
  EXPECT_EQ(anchor_at(from, to, 1), to);
  EXPECT_LT((anchor_at(from, to, 0.25) - Vector(1.75, 2.75, 0.75)).norm(), 1e-15);
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
