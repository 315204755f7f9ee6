// The matrix of bending steps against the polynomial that it stands for.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <bit>
#include <cmath>

#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A sheet of cells of 5 mm, held at a corner. As a plate where it says so; else by hinges.
Scene fine_sheet(std::uint32_t steps, bool as_plate, double cell = 0.005) {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{static_cast<float>(8 * cell), static_cast<float>(6 * cell)}, 8, 6, Topology::diagonal, true};
  cloth.fabric = *fabric_preset("denim");
  cloth.bends_as_plate = as_plate;
  cloth.tethers = false;
  cloth.anchors.emplace_back().corners = {Corner::low_high};
  scene.solver.bend_steps = steps;
  return scene;
}

// What a visit takes off places: M, with the diagonal by which rows sum to zero.
MatrixXd taken_off(const CookedFabric& fabric) {
  const auto n = static_cast<Eigen::Index>(fabric.positions.size());
  MatrixXd matrix = MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const gpu::uvec2 row = fabric.bend.rows[static_cast<std::size_t>(i)];
    for (std::uint32_t k = 0; k < row.y; ++k) {
      const gpu::uvec4& pair = fabric.bend.pairs[row.x + k / 2];
      const double value = std::bit_cast<float>(k % 2 == 0 ? pair.y : pair.w);
      matrix(i, k % 2 == 0 ? pair.x : pair.z) += value, matrix(i, i) -= value;
    }
  }
  return matrix;
}

struct System {
  MatrixXd stencils;              // K
  VectorXd weights, softness;     // w, and alpha / h^2
  VectorXd bounds;                // of each stencil: sum n_j w_j K_j^2
  explicit System(const CookedFabric& fabric) {
    const auto n = static_cast<Eigen::Index>(fabric.positions.size()), count = static_cast<Eigen::Index>(fabric.bends.size());
    stencils = MatrixXd::Zero(count, n), weights.resize(n), softness.resize(count);
    VectorXd uses = VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) weights[i] = fabric.positions[static_cast<std::size_t>(i)].w;
    for (Eigen::Index e = 0; e < count; ++e) {
      const gpu::Bend& bend = fabric.bends[static_cast<std::size_t>(e)];
      for (int c = 0; c < 4; ++c) stencils(e, bend.particle[c]) += bend.k[c];
      for (int c = 0; c < (bend.k[3] == 0 ? 3 : 4); ++c) uses[bend.particle[c]] += 1;
      softness[e] = bend.compliance / (fabric.h * fabric.h);
    }
    bounds = stencils.cwiseAbs2() * uses.cwiseProduct(weights);
  }
  // W K^T q(L) C^-1 K with q(l) = (1 - left(l)) / l, C no less than the bounds over `most`.
  template <class Left>
  MatrixXd solved(double most, Left left) const {
    const VectorXd root = softness.cwiseMax(bounds / most).cwiseSqrt().cwiseInverse();
    const MatrixXd gram = stencils * weights.asDiagonal() * stencils.transpose();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(root.asDiagonal() * gram * root.asDiagonal());
    EXPECT_LE(modes.eigenvalues().maxCoeff(), most * (1 + 1e-9));
    EXPECT_GT(modes.eigenvalues().maxCoeff(), 0.5 * most);   // the bound is no waste
    const VectorXd part = modes.eigenvalues().unaryExpr([&](double l) { return std::abs(l) < 1e-6 ? 1 : (1 - left(l)) / l; });
    EXPECT_LE(modes.eigenvalues().unaryExpr([&](double l) { return -left(l); }).maxCoeff(), 0.25 + 1e-9);
    const MatrixXd sides = root.asDiagonal() * modes.eigenvectors();
    return weights.asDiagonal() * stencils.transpose() * (sides * part.asDiagonal() * sides.transpose()) * stencils;
  }
};

// T_m(x), by its recurrence, and its slope by U_(m-1)(x).
double chebyshev(std::uint32_t m, double x) {
  double before = 1, value = x;
  for (std::uint32_t k = 1; k < m; ++k) std::swap(before, value), value = 2 * x * before - value;
  return value;
}
double chebyshev_slope(std::uint32_t m, double x) {
  double before = 0, value = 1;
  for (std::uint32_t k = 1; k < m; ++k) std::swap(before, value), value = 2 * x * before - value;
  return m * value;
}

TEST(BendMatrix, steps_leave_what_a_polynomial_of_chebyshev_leaves) {
  double most_of_fewer = 0;
  for (std::uint32_t m = 1; m <= 4; ++m) {
    const double c = std::cosh(std::acosh(4.0) / m), slope = chebyshev_slope(m, c) / 4, most = (c + 1) * slope;
    const auto left = [&](double l) { return chebyshev(m, c - l / slope) / 4; };
    EXPECT_NEAR(left(0), 1, 1e-12);
    EXPECT_NEAR((1 - left(1e-6)) / 1e-6, 1, 1e-5);   // smooth folds feel the whole of their rigidity
    EXPECT_GT(most, most_of_fewer + 1.2 * m);
    most_of_fewer = most;
    for (const bool as_plate : {true, false}) {
      SCOPED_TRACE(std::to_string(m) + (as_plate ? " steps, a plate" : " steps, hinges"));
      const CookedFabric fabric = cooked(fine_sheet(m, as_plate));
      const MatrixXd measured = taken_off(fabric), wanted = System(fabric).solved(most, left);
      EXPECT_LT((measured - wanted).norm(), 1e-6 * wanted.norm());
    }
  }
}

TEST(BendMatrix, steps_conserve_momentum_and_leave_flat_poses_alone) {
  for (const std::uint32_t steps : {1u, 3u}) {
    const CookedFabric fabric = cooked(fine_sheet(steps, true));
    const MatrixXd measured = taken_off(fabric);
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
    fan.positions.push_back({0.01f * std::cos(angle), 0, 0.01f * std::sin(angle)});
    fan.triangles.push_back({0, 1 + (k + 1) % kCorners, 1 + k});
  }
  fan.normals.assign(fan.positions.size(), {0, 1, 0});
  fan.tangents.assign(fan.positions.size(), {1, 0, 0, 1});
  fan.uvs.assign(fan.positions.size(), {0, 0});
  Scene scene = without_contacts();
  scene.cloths.emplace_back().name = "fan";
  scene.solver.bend_steps = 4;
  const CookedFabric fabric = must(cook(scene, std::vector<Mesh>{must(weld_mesh(std::move(fan)))}));
  EXPECT_LT(fabric.bend.pairs.size(), 100u * kCorners);
  ASSERT_FALSE(fabric.notes.empty());
  EXPECT_NE(fabric.notes.back().find("fan: so many triangles share a vertex that bending takes fewer than 4 steps"), std::string::npos)
      << fabric.notes.back();
}

TEST(BendMatrix, steps_without_effect_are_told) {
  Scene scene = fine_sheet(3, true);
  scene.solver.iterations = 2;
  const CookedFabric fabric = cooked(scene);
  ASSERT_FALSE(fabric.notes.empty());
  EXPECT_NE(fabric.notes.back().find("solver.bend_steps: 3 has no effect"), std::string::npos) << fabric.notes.back();
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
