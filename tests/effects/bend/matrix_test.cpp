// The matrix of several bending steps against the polynomial that it stands for.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <bit>
#include <cmath>

#include "tests/support/cooked.h"

namespace weft {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A sheet of cells of 5 mm, held at a corner. As a plate where it says so; else by hinges.
Scene fine_sheet(std::uint32_t steps, bool as_plate, double cell = 0.005) {
  Scene scene;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{static_cast<float>(8 * cell), static_cast<float>(6 * cell)}, 8, 6, Topology::diagonal, true};
  cloth.fabric = *fabric_preset("denim");
  cloth.bends_as_plate = as_plate;
  cloth.tethers = false;
  cloth.anchors.emplace_back().corners = {Corner::low_high};
  scene.solver.bend_steps = steps;
  return scene;
}

// What a visit takes off places: omega M, with the diagonal by which rows sum to zero.
MatrixXd taken_off(const CookedFabric& fabric, double relaxation) {
  const auto n = static_cast<Eigen::Index>(fabric.positions.size());
  MatrixXd matrix = MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const gpu::uvec2 row = fabric.bend.rows[static_cast<std::size_t>(i)];
    for (std::uint32_t k = 0; k < row.y; ++k) {
      const gpu::uvec4& pair = fabric.bend.pairs[row.x + k / 2];
      const double value = relaxation * std::bit_cast<float>(k % 2 == 0 ? pair.y : pair.w);
      matrix(i, k % 2 == 0 ? pair.x : pair.z) += value, matrix(i, i) -= value;
    }
  }
  return matrix;
}

struct System {
  MatrixXd stencils;                  // K
  VectorXd weights, softness, step;   // w, alpha / h^2, D
  double least = 0;                   // eigenvalue of D^-1 (alpha~ + K W K^T)
  explicit System(const CookedFabric& fabric) {
    const auto n = static_cast<Eigen::Index>(fabric.positions.size()), count = static_cast<Eigen::Index>(fabric.bends.size());
    stencils = MatrixXd::Zero(count, n), weights.resize(n), softness.resize(count), step.resize(count);
    for (Eigen::Index i = 0; i < n; ++i) weights[i] = fabric.positions[static_cast<std::size_t>(i)].w;
    for (Eigen::Index e = 0; e < count; ++e) {
      const gpu::Bend& bend = fabric.bends[static_cast<std::size_t>(e)];
      for (int c = 0; c < 4; ++c) stencils(e, bend.particle[c]) += bend.k[c];
      softness[e] = bend.compliance / (fabric.h * fabric.h);
      step[e] = bend.split_weight + softness[e];
    }
    least = (softness.array() / step.array()).minCoeff();
  }
  // W K^T q(T) D^-1 K with q(t) = (1 - left(t)) / t.
  template <class Left>
  MatrixXd solved(Left left) const {
    const VectorXd root = step.cwiseSqrt().cwiseInverse();
    const MatrixXd gram = MatrixXd(softness.asDiagonal()) + stencils * weights.asDiagonal() * stencils.transpose();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(root.asDiagonal() * gram * root.asDiagonal());
    EXPECT_GE(modes.eigenvalues().minCoeff(), least * (1 - 1e-9));
    EXPECT_LE(modes.eigenvalues().maxCoeff(), 1 + 1e-9);
    const VectorXd part = modes.eigenvalues().unaryExpr([&](double t) { return (1 - left(t)) / t; });
    const MatrixXd sides = root.asDiagonal() * modes.eigenvectors();
    return weights.asDiagonal() * stencils.transpose() * (sides * part.asDiagonal() * sides.transpose()) * stencils;
  }
};

// T_m(x), by its recurrence.
double chebyshev(std::uint32_t m, double x) {
  double before = 1, value = x;
  for (std::uint32_t k = 1; k < m; ++k) std::swap(before, value), value = 2 * x * before - value;
  return value;
}

TEST(BendMatrix, several_steps_leave_what_a_polynomial_of_chebyshev_leaves) {
  for (const bool as_plate : {true, false})
    for (std::uint32_t m = 2; m <= 4; ++m) {
      SCOPED_TRACE(std::to_string(m) + (as_plate ? " steps, a plate" : " steps, hinges"));
      const Scene scene = fine_sheet(m, as_plate);
      const CookedFabric fabric = cooked(scene);
      const System system(fabric);
      // The interval [d, 1] on which a quarter is left: T_m((1 + d) / (1 - d)) = 4.
      const double c = std::cosh(std::acosh(4.0) / m), low = std::max(system.least, (c - 1) / (c + 1));
      const auto left = [&](double t) { return chebyshev(m, (1 + low - 2 * t) / (1 - low)) / chebyshev(m, (1 + low) / (1 - low)); };
      const MatrixXd measured = taken_off(fabric, relaxation_of(scene)), wanted = system.solved(left);
      EXPECT_LT((measured - wanted).norm(), 1e-6 * wanted.norm());
      // Of what the smoothest folds should feel they feel so many times what one step of 1.25 gives them.
      EXPECT_GT((1 - left(system.least)) / (1.25 * system.least), m == 2 ? 2.5 : m == 3 ? 5 : 8);
    }
}

TEST(BendMatrix, several_steps_conserve_momentum_and_leave_flat_poses_alone) {
  const Scene scene = fine_sheet(3, true);
  const CookedFabric fabric = cooked(scene);
  const MatrixXd measured = taken_off(fabric, relaxation_of(scene));
  const auto n = measured.rows();
  VectorXd slope(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const gpu::vec4& p = fabric.positions[static_cast<std::size_t>(i)];
    slope[i] = 0.3 * p.x - 0.7 * p.y;
    for (Eigen::Index j = 0; j < n; ++j) {
      const double w = p.w, other = fabric.positions[static_cast<std::size_t>(j)].w;
      if (w == 0 || other == 0) continue;
      ASSERT_NEAR(measured(i, j) / w, measured(j, i) / other, 1e-6 * measured(i, i) / w) << i << " " << j;
    }
  }
  EXPECT_LT((measured * slope).cwiseAbs().maxCoeff(), 1e-6 * slope.cwiseAbs().maxCoeff());
}

// Cells of 5 cm bend as much as they should in one step, and pay for no more.
TEST(BendMatrix, no_more_steps_are_taken_than_are_needed) {
  const auto entries = [](const Scene& scene) { return cooked(scene).bend.pairs.size(); };
  EXPECT_EQ(entries(fine_sheet(4, true, 0.05)), entries(fine_sheet(1, true, 0.05)));
  EXPECT_GT(entries(fine_sheet(2, true)), 2 * entries(fine_sheet(1, true)));
  EXPECT_GT(entries(fine_sheet(3, true)), entries(fine_sheet(2, true)));
}

// A fan of two thousand triangles: with two steps all of its corners would feel each other, four million entries.
TEST(BendMatrix, a_vertex_of_thousands_of_triangles_takes_fewer_steps_and_says_so) {
  constexpr std::uint32_t kCorners = 2000;
  RenderMesh fan;
  fan.positions.push_back({0, 0, 0});
  for (std::uint32_t k = 0; k < kCorners; ++k) {
    const float angle = 6.2831853f * static_cast<float>(k) / kCorners;
    fan.positions.push_back({std::cos(angle), 0, std::sin(angle)});
    fan.triangles.push_back({0, 1 + (k + 1) % kCorners, 1 + k});
  }
  fan.normals.assign(fan.positions.size(), {0, 1, 0});
  fan.tangents.assign(fan.positions.size(), {1, 0, 0, 1});
  fan.uvs.assign(fan.positions.size(), {0, 0});
  Scene scene;
  scene.cloths.emplace_back().name = "fan";
  scene.solver.bend_steps = 4;
  const CookedFabric fabric = must(cook(scene, std::vector<Mesh>{must(weld_mesh(std::move(fan)))}));
  EXPECT_LT(fabric.bend.pairs.size(), 100u * kCorners);
  ASSERT_FALSE(fabric.notes.empty());
  EXPECT_NE(fabric.notes.back().find("fan: so many triangles share a vertex that bending takes fewer than 4 steps"), std::string::npos)
      << fabric.notes.back();
}

TEST(BendMatrix, steps_without_effect_are_told) {
  for (const bool iterated : {true, false}) {
    Scene scene = fine_sheet(3, true);
    if (iterated) scene.solver.iterations = 2;
    else scene.solver.averaging = Averaging::count;
    const CookedFabric fabric = cooked(scene);
    ASSERT_FALSE(fabric.notes.empty());
    EXPECT_NE(fabric.notes.back().find("solver.bend_steps: 3 has no effect"), std::string::npos) << fabric.notes.back();
  }
  EXPECT_TRUE(cooked(fine_sheet(3, true)).notes.empty());
}

// Where the host may hold particles, the rows have room for all of them whoever is held.
TEST(BendMatrix, which_entries_there_are_does_not_depend_on_who_is_held) {
  Scene held = fine_sheet(3, true), free = held;
  held.pins = free.pins = 4;
  free.cloths[0].anchors.clear();
  const CookedFabric first = cooked(held), second = cooked(free);
  ASSERT_EQ(first.bend.rows.size(), second.bend.rows.size());
  for (std::size_t i = 0; i < first.bend.rows.size(); ++i) EXPECT_EQ(first.bend.rows[i].y, second.bend.rows[i].y) << i;
}

}  // namespace
}  // namespace weft
