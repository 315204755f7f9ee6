// Cooked cloth against the plate that it stands for, of rigidity B and without Poisson's ratio: 1/2 B (w_xx^2 + 2 w_xy^2 + w_yy^2) per area,
// free rims included.
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "engine/fabric.h"
#include "engine/mesh.h"
#include "tests/support/twins.h"
#include "tests/support/without_contacts.h"

namespace weft::reference {
namespace {

constexpr double kRigidity = 1e-3;   // N m
constexpr Vec2 kSize{0.4f, 0.3f};    // m

struct Sheet {
  std::string name;
  Scene scene = without_contacts();
  std::vector<Mesh> meshes;
};

Sheet sheet(std::string name, Vec2 size, std::uint32_t cells_x, std::uint32_t cells_y, Topology topology, double shake = 0) {
  Sheet made{std::move(name), {}, {}};
  Cloth& cloth = made.scene.cloths.emplace_back();
  cloth.grid = Grid{size, cells_x, cells_y, topology, false};
  cloth.bends_as_plate = true;
  cloth.fabric.bend = kRigidity;
  cloth.tethers = false;
  cloth.start.imperfection = 0;
  auto meshes = make_meshes(made.scene);
  EXPECT_TRUE(meshes);
  made.meshes = std::move(*meshes);
  // Inner points only, so that the area stays what it is.
  Random random(3);
  const double side = shake * size.x / cells_x;
  for (Vec3& p : made.meshes[0].points) {
    const double x = between(random, -side, side), z = between(random, -side, side);
    if (std::abs(p.x) < 0.49 * size.x && std::abs(p.z) < 0.49 * size.y) p = {p.x + float(x), p.y, p.z + float(z)};
  }
  return made;
}

CookedFabric cooked_sheet(const Sheet& sheet) {
  auto fabric = cook(sheet.scene, sheet.meshes);
  EXPECT_TRUE(fabric) << fabric.error();
  return std::move(*fabric);
}

using Height = std::function<double(double x, double z)>;

double energy(const CookedFabric& fabric, const Height& height) {
  double sum = 0;
  for (const gpu::Bend& bend : fabric.bends) {
    double l = 0;
    for (int j = 0; j < 4; ++j) {
      const gpu::vec4& p = fabric.positions[bend.particle[j]];
      l += double(bend.k[j]) * height(p.x, p.z);
    }
    sum += l * l / (2 * bend.compliance);
  }
  return sum;
}

struct Shape {
  const char* name;
  double along, across;   // curvatures (1/m)
};
constexpr Shape kShapes[] = {{"cylinder", 1, 0}, {"saddle", 1, -1}, {"dome", 1, 1}, {"half a dome", 1, 0.5}};

// The least and the most of the plate's energy that quadratic heights have, over all shapes and directions.
std::pair<double, double> parts_of_a_plates_energy(const Sheet& sheet) {
  const CookedFabric fabric = cooked_sheet(sheet);
  const double area = double(sheet.scene.cloths[0].grid->size.x) * sheet.scene.cloths[0].grid->size.y;
  std::pair<double, double> part{INFINITY, 0};
  for (const Shape& shape : kShapes)
    for (int degrees = 0; degrees < 180; degrees += 5) {
      const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
      const Height height = [&](double x, double z) {
        const double u = c * x + s * z, v = c * z - s * x;
        return 0.5 * (shape.along * u * u + shape.across * v * v);
      };
      const double plate = 0.5 * kRigidity * (shape.along * shape.along + shape.across * shape.across) * area;
      const double measured = energy(fabric, height) / plate;
      part = {std::min(part.first, measured), std::max(part.second, measured)};
    }
  return part;
}

TEST(Plate, quadratic_heights_have_its_energy_in_every_direction) {
  for (const Sheet& squares : {sheet("diagonal", kSize, 16, 12, Topology::diagonal), sheet("centre", kSize, 16, 12, Topology::centre),
                               sheet("oblong cells", kSize, 24, 6, Topology::diagonal),
                               sheet("two cells wide", {0.4f, 0.04f}, 20, 2, Topology::diagonal)}) {
    const auto [least, most] = parts_of_a_plates_energy(squares);
    // Points are floats: 2e-8 m of cells of 0.01 m, of second differences of 1e-4 m times the size.
    EXPECT_NEAR(least, 1, 1e-3) << squares.name;
    EXPECT_NEAR(most, 1, 1e-3) << squares.name;
  }
}

TEST(Plate, where_cells_are_not_quite_square_it_has_nearly_its_energy) {
  for (const Sheet& shaken : {sheet("diagonal", kSize, 16, 12, Topology::diagonal, 0.07),
                              sheet("centre", kSize, 16, 12, Topology::centre, 0.05)}) {
    const auto [least, most] = parts_of_a_plates_energy(shaken);
    EXPECT_GT(least, 0.9) << shaken.name;
    EXPECT_LT(most, 1.1) << shaken.name;
  }
}

// Stretched and sheared as one likes, as long as it is by one map: the sums of K and of K x are nothing, but for single precision.
TEST(Plate, no_flat_pose_has_energy) {
  for (const Sheet& one : {sheet("diagonal", kSize, 16, 12, Topology::diagonal), sheet("shaken", kSize, 16, 12, Topology::diagonal, 0.3),
                           sheet("centre", kSize, 16, 12, Topology::centre, 0.1)}) {
    const CookedFabric fabric = cooked_sheet(one);
    for (const gpu::Bend& bend : fabric.bends) {
      double sum = 0, x = 0, z = 0, size = 0;
      for (int j = 0; j < 4; ++j) {
        const gpu::vec4& p = fabric.positions[bend.particle[j]];
        sum += double(bend.k[j]), x += double(bend.k[j]) * p.x, z += double(bend.k[j]) * p.z, size += std::abs(bend.k[j]);
      }
      EXPECT_LT(std::abs(sum), 1e-6 * size) << one.name;
      EXPECT_LT(std::hypot(x, z), 1e-6 * size * kSize.x) << one.name;
    }
  }
}

// What has no lattice bends by hinges. A cut through a lattice must not lose or double what lies beside it.
TEST(Plate, hinges_and_a_lattice_share_a_mesh_without_a_gap) {
  Sheet half = sheet("half shaken", kSize, 16, 12, Topology::diagonal);
  Random random(5);
  for (Vec3& p : half.meshes[0].points)
    if (p.x > 0.01f && p.x < 0.19f && std::abs(p.z) < 0.14f)
      p = {p.x + float(between(random, -0.009, 0.009)), 0, p.z + float(between(random, -0.009, 0.009))};
  const CookedFabric fabric = cooked_sheet(half);
  const Height cylinder = [](double x, double) { return 0.5 * x * x; };
  const double measured = energy(fabric, cylinder) / (0.5 * kRigidity * kSize.x * kSize.y);
  EXPECT_GT(measured, 0.9);
  EXPECT_LT(measured, 1.6);   // hinges in cells shaken by a third
}

// The heights of a strip along x that is clamped over its first cell and carries its weight, by the cooked energy itself. Over the depth of a
// beam, rho g L^4 / (8 B).
double cantilever(const Sheet& strip) {
  const CookedFabric fabric = cooked_sheet(strip);
  const Cloth& cloth = strip.scene.cloths[0];
  const double first = -0.5 * cloth.grid->size.x, clamp = first + double(cloth.grid->size.x) / cloth.grid->cells_x;
  std::vector<Eigen::Index> unknown(fabric.positions.size(), -1);
  Eigen::Index count = 0;
  for (std::size_t i = 0; i < unknown.size(); ++i)
    if (fabric.positions[i].x > clamp + 1e-6) unknown[i] = count++;
  std::vector<Eigen::Triplet<double>> entries;
  for (const gpu::Bend& bend : fabric.bends)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        if (const auto a = unknown[bend.particle[i]], b = unknown[bend.particle[j]]; a >= 0 && b >= 0)
          entries.emplace_back(static_cast<int>(a), static_cast<int>(b), double(bend.k[i]) * bend.k[j] / bend.compliance);
  Eigen::SparseMatrix<double> stiffness(count, count);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd weight(count);
  for (std::size_t i = 0; i < unknown.size(); ++i)
    if (unknown[i] >= 0) weight[unknown[i]] = 9.81 / fabric.positions[i].w;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(stiffness);
  EXPECT_EQ(factor.info(), Eigen::Success);
  const Eigen::VectorXd sinks = factor.solve(weight);
  double tip = 0, ends = 0;
  for (std::size_t i = 0; i < unknown.size(); ++i)
    if (fabric.positions[i].x > -first - 1e-6) tip += sinks[unknown[i]], ++ends;
  return tip / ends / (cloth.fabric.area_density * 9.81 * std::pow(-first - clamp, 4) / (8 * cloth.fabric.bend));
}

TEST(Plate, a_cantilever_sinks_as_a_beam_does) {
  for (const Topology topology : {Topology::diagonal, Topology::centre})
    for (const std::uint32_t across : {1u, 2u, 4u, 10u}) {
      const double sinks = cantilever(sheet("strip", {0.4f, 0.04f}, 10 * across, across, topology));
      EXPECT_NEAR(sinks, 1, 0.1) << (topology == Topology::centre ? "centre, " : "diagonal, ") << across << " cells wide";
      RecordProperty("sinks_" + std::to_string(static_cast<int>(topology)) + "_" + std::to_string(across), std::to_string(sinks));
    }
}

}  // namespace
}  // namespace weft::reference
