// The twin of the hinges against what it must be by itself: slopes, moments, the isometric model where nearly flat; and what is cooked.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/fabric.h"
#include "shaders/bend/bend.ref.h"
#include "shaders/dihedral/dihedral.ref.h"
#include "tests/support/twins.h"
#include "tests/support/without_contacts.h"

namespace weft::reference {
namespace {

constexpr double kPi = std::numbers::pi;

// An edge of 0.5 to 2 m and triangles of any shape beside it, their heights at least 0.3 m, that make an angle.
HingePose pose(Random& random, double angle) {
  const double length = between(random, 0.5, 2), s2 = between(random, -1, 2), s3 = between(random, -1, 2);
  const double h2 = between(random, 0.3, 1), h3 = between(random, 0.3, 1);
  HingePose x{Vector::Zero(), Vector(length, 0, 0), Vector(s2 * length, h2, 0),
              Vector(s3 * length, -h3 * std::cos(angle), h3 * std::sin(angle))};
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1), 0.5).normalized().toRotationMatrix();
  const Vector shift = anywhere(random, 10);
  for (Vector& p : x) p = turn * p + shift;
  return x;
}

TEST(DihedralTwin, its_angle_is_nothing_where_flat_and_a_half_turn_where_closed) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const double angle = between(random, -kPi, kPi);
    EXPECT_NEAR(std::abs(hinge_angle(pose(random, angle))), std::abs(angle), 1e-12);
    EXPECT_NEAR(hinge_angle(pose(random, 0)), 0, 1e-13);
    EXPECT_NEAR(std::abs(hinge_angle(pose(random, kPi))), kPi, 1e-13);
    EXPECT_NEAR(hinge_angle(pose(random, angle)) / hinge_angle(pose(random, -angle)), -1, 1e-9);
  }
}

// At every angle, flat and closed ones too, where the energy of an angle subtracted would jump.
TEST(DihedralTwin, its_gradient_is_the_slope_of_its_energy_in_every_pose) {
  Random random(2);
  for (const double angle : {0.0, 1e-3, 0.5, kPi / 2, 3.0, kPi, -kPi / 2, -3.0})
    for (int trial = 0; trial < 50; ++trial) {
      const HingePose x = pose(random, angle);
      const Hinge hinge{{0, 1, 2, 3}, between(random, -2, 2), 0.7};
      if (std::abs(std::abs(hinge_value(hinge.rest, x)) - kPi) < 0.01) continue;   // half a turn off there are two ways back
      const HingePose gradient = hinge_gradient(x);
      for (std::size_t j = 0; j < 4; ++j) {
        const Vector slope = difference([&](const Vector& moved) { HingePose q = x; q[j] = moved; return hinge_energy(hinge, q); }, x[j]);
        const Vector wanted = hinge_value(hinge.rest, x) / hinge.compliance * gradient[j];
        EXPECT_LT((slope - wanted).norm(), 1e-7 * (1 + wanted.norm())) << angle << ", particle " << j;
      }
    }
}

TEST(DihedralTwin, its_gradients_and_their_moments_sum_to_nothing) {
  Random random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const HingePose x = pose(random, between(random, -kPi, kPi));
    const HingePose gradient = hinge_gradient(x);
    Vector sum = Vector::Zero(), moment = Vector::Zero();
    double size = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      sum += gradient[j];
      moment += (x[j] - x[0]).cross(gradient[j]);
      size += gradient[j].norm();
    }
    EXPECT_LT(sum.norm(), 1e-13 * size);
    EXPECT_LT(moment.norm(), 1e-12 * size);
  }
}

// A mesh of a sheet that is rolled up by `curvature` (1/m) and shaken within its surface.
Mesh rolled(double curvature, Random& random, std::uint32_t cells = 9) {
  Mesh mesh = make_grid({.size = {1, 1}, .cells_x = cells, .cells_y = 7, .topology = Topology::centre});
  for (Vec3& p : mesh.points) {
    const double x = p.x + between(random, -0.01, 0.01), z = p.z + between(random, -0.01, 0.01), turn = curvature * x;
    p = {static_cast<float>(curvature > 0 ? std::sin(turn) / curvature : x),
         static_cast<float>(curvature > 0 ? (1 - std::cos(turn)) / curvature : 0), static_cast<float>(z)};
  }
  return mesh;
}

CookedFabric cooked(const Mesh& mesh, BendRest rest, Averaging averaging = Averaging::mass_split) {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{};   // its points are the mesh's
  cloth.fabric.bend = 3e-5;
  cloth.bend_rest = rest;
  cloth.start.imperfection = 0;
  scene.solver.averaging = averaging;
  auto fabric = cook(scene, std::span(&mesh, 1));
  EXPECT_TRUE(fabric) << fabric.error();
  return std::move(*fabric);
}

HingePose pose_of(const CookedFabric& fabric, const std::uint32_t (&particle)[4]) {
  HingePose x;
  for (std::size_t j = 0; j < 4; ++j)
    x[j] = Vector(fabric.positions[particle[j]].x, fabric.positions[particle[j]].y, fabric.positions[particle[j]].z);
  return x;
}

TEST(DihedralTwin, cooking_rests_at_the_meshs_angles_and_splits_masses_among_hinges) {
  for (const Averaging averaging : {Averaging::mass_split, Averaging::count}) {
    Random random(4);
    const CookedFabric fabric = cooked(rolled(5, random), BendRest::mesh, averaging);
    EXPECT_TRUE(fabric.bends.empty() && fabric.bend.pairs.empty() && fabric.bend_uses.pairs.empty());
    ASSERT_GT(fabric.hinges.size(), 200u);
    std::vector<int> uses(fabric.positions.size());
    for (const gpu::Hinge& hinge : fabric.hinges)
      for (const std::uint32_t p : hinge.particle) ++uses[p];
    double largest = 0;
    for (const gpu::Hinge& hinge : fabric.hinges) {
      const HingePose x = pose_of(fabric, hinge.particle);
      const double rest = std::atan2(hinge.rest_sine, hinge.rest_cosine);
      EXPECT_NEAR(hinge_angle(x), rest, 1e-6);   // two floats
      largest = std::max(largest, std::abs(rest));
      const double area = ((x[1] - x[0]).cross(x[2] - x[0]).norm() + (x[1] - x[0]).cross(x[3] - x[0]).norm()) / 2;
      EXPECT_NEAR(hinge.compliance * 3e-5 * (x[1] - x[0]).squaredNorm() / area, 1, 1e-5);
      for (int j = 0; j < 4; ++j) {
        const std::uint32_t p = hinge.particle[j];
        EXPECT_FLOAT_EQ(hinge.weight[j], (averaging == Averaging::mass_split ? static_cast<float>(uses[p]) : 1) * fabric.positions[p].w);
      }
    }
    EXPECT_GT(largest, 0.3);   // 5 / m over cells of 0.11 m
  }
}

// Out of the plane by little: the same energies, stencil by stencil, up to the fourth power of what is out of it over the cells' size.
TEST(DihedralTwin, a_nearly_flat_mesh_has_the_isometric_models_energy) {
  Random random(5);
  const Mesh mesh = rolled(0, random, 14);   // cells of two squares make quads of 53 degrees: no lattice, so that both have hinges
  const CookedFabric hinged = cooked(mesh, BendRest::mesh), isometric = cooked(mesh, BendRest::flat);
  ASSERT_EQ(hinged.hinges.size(), isometric.bends.size());
  std::vector<double> height(hinged.positions.size());
  for (double& y : height) y = between(random, -1e-4, 1e-4);
  double energies = 0;
  for (std::size_t e = 0; e < hinged.hinges.size(); ++e) {
    const gpu::Hinge& hinge = hinged.hinges[e];
    const gpu::Bend& bend = isometric.bends[e];
    ASSERT_TRUE(std::equal(hinge.particle, hinge.particle + 4, bend.particle));
    HingePose x = pose_of(hinged, hinge.particle);
    for (std::size_t j = 0; j < 4; ++j) x[j].y() += height[hinge.particle[j]];
    const double angle = hinge_energy({{}, 0, hinge.compliance}, x);
    const double quadratic =
        bend_value({bend.k[0], bend.k[1], bend.k[2], bend.k[3]}, {x[0], x[1], x[2], x[3]}).squaredNorm() / (2 * bend.compliance);
    // The stencil's K are floats, so that the plane itself leaves 1e-8 of its size of 0.1 m: 1e-5 of the heights.
    EXPECT_NEAR(angle, quadratic, 1e-3 * (angle + 1e-14));
    energies += angle;
  }
  EXPECT_GT(energies, 1e-12);
}

TEST(DihedralTwin, slivers_are_softened_and_counted) {
  Mesh mesh = make_grid({.size = {1, 1}, .cells_x = 2, .cells_y = 2});
  mesh.points[4].x = 0.499f;   // the middle one: beside an edge, nearly
  const CookedFabric hinged = cooked(mesh, BendRest::mesh), isometric = cooked(mesh, BendRest::flat);
  ASSERT_EQ(hinged.notes.size(), 1u);
  EXPECT_NE(hinged.notes[0].find("hinges lie on slivers; their stiffness was limited"), std::string::npos) << hinged.notes[0];
  EXPECT_EQ(hinged.notes[0].substr(0, hinged.notes[0].find(" hinges")), isometric.notes[0].substr(0, isometric.notes[0].find(" bending")));
  for (const gpu::Hinge& hinge : hinged.hinges) EXPECT_TRUE(std::isfinite(hinge.compliance) && hinge.compliance > 0);
}

}  // namespace
}  // namespace weft::reference
