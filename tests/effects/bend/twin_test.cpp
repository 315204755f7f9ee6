// The twin of the bending passes against what it must be by itself: flat poses, slopes, momentum, cylinders of known energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/fabric.h"
#include "shaders/bend/bend.ref.h"
#include "tests/support/twins.h"
#include "tests/support/without_contacts.h"

namespace weft::reference {
namespace {

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
    for (std::size_t j = 0; j < 4; ++j) {
      const Vec3 at = mesh.points[bend.particle[j]];
      x[j] = Vector(at.x, at.y, at.z);
    }
    bend.k = bend_stencil(x).k;
    bend.compliance = 1 / (0.1 * bend_stencil(x).q);   // stiff, so that rounding of positions is small against the motion
    bends.push_back(bend);
  }
  const auto drift = [&](Averaged averaging) {
    std::vector<Vector> lambda(bends.size(), Vector::Zero());
    const Points q = relax_bend(bends, p, w, lambda, 1.0 / 720, 1, averaging);
    Vector sum = Vector::Zero();
    double size = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += (q[i] - p[i]) / w[i], size += (q[i] - p[i]).norm() / w[i];
    return sum.norm() / size;
  };
  EXPECT_LT(drift(Averaged::mass_split), 1e-12);
  EXPECT_GT(drift(Averaged::count), 1e-4);
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
  Scene scene = without_contacts();
  scene.cloths.emplace_back().grid = Grid{{1, 1}, 14, 7, Topology::centre, false};   // quads of 53 degrees are no lattice
  scene.cloths[0].fabric.bend = 3e-5;
  scene.cloths[0].start.imperfection = 0;
  auto meshes = make_meshes(scene);
  ASSERT_TRUE(meshes);
  for (Vec3& p : (*meshes)[0].points) {
    const Vector d = anywhere(random, 0.01);
    p = {p.x + static_cast<float>(d.x()), p.y, p.z + static_cast<float>(d.z())};
  }
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
    const Eigen::Vector4d k(bend.k[0], bend.k[1], bend.k[2], bend.k[3]);
    EXPECT_LT((k - wanted.k).norm(), 1e-7 * wanted.k.norm());   // stored as floats
    EXPECT_NEAR(bend.compliance * 3e-5 * wanted.q, 1, 1e-7);
  }
}

}  // namespace
}  // namespace weft::reference
