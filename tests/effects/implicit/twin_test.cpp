// The implicit particle system on the CPU: its springs, its two solvers, and motions that are known beforehand.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <bit>
#include <cmath>
#include <random>
#include <set>

#include "engine/effects/implicit/implicit.h"
#include "engine/reference/implicit.h"
#include "shaders/bend/bend.ref.h"
#include "shaders/packed.h"
#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft::reference {
namespace {

Scene implicit_scene(Linear linear, std::uint32_t iterations) {
  Scene scene = without_contacts();
  scene.solver.method = Method::implicit;
  scene.solver.linear = linear;
  scene.solver.iterations = iterations;
  scene.solver.rate = 100;
  scene.solver.substeps = 1;
  return scene;
}

// A free sheet of 1 m by 1 m in the xz plane, of 24 neighbours a particle.
Scene sheet(std::uint32_t cells, Linear linear = Linear::cg, std::uint32_t iterations = 30) {
  Scene scene = implicit_scene(linear, iterations);
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, cells, cells, Topology::diagonal, false};
  cloth.fabric.damping = 0;
  cloth.tethers = false;
  cloth.springs = Springs{{500, 0.01}, {500, 0.01}, {50, 0.001}};
  return scene;
}

ImplicitSystem system_of(const Scene& scene, const CookedFabric& fabric) {
  auto system = ImplicitSystem::create(scene, fabric);
  EXPECT_TRUE(system) << system.error();
  return std::move(*system);
}

// Particles on a vertical line, the first of them held, each hung from the one before it.
CookedFabric chain(std::uint32_t particles, double mass, double rest, double stiffness, double damping, double h) {
  CookedFabric fabric;
  fabric.h = h;
  fabric.jacobi_weight = 2.0 / 3;
  fabric.materials.push_back({1, 0, 0, 0});
  for (std::uint32_t i = 0; i < particles; ++i) {
    fabric.positions.push_back({0, static_cast<float>(-rest * i), 0, i == 0 ? 0 : static_cast<float>(1 / mass)});
    fabric.velocities.push_back({0, 0, 0, std::bit_cast<float>(0u)});
    if (i > 0)
      fabric.springs.push_back({i - 1, i, static_cast<float>(rest), static_cast<float>(stiffness), static_cast<float>(damping), false});
  }
  return fabric;
}

Eigen::MatrixXd dense(const ImplicitEquations& equations) {
  const Eigen::Index n = equations.right.cols();
  Eigen::MatrixXd matrix(3 * n, 3 * n);
  for (Eigen::Index k = 0; k < 3 * n; ++k) {
    Columns unit = Columns::Zero(3, n);
    unit(k % 3, k / 3) = 1;
    matrix.col(k) = equations.times(unit).reshaped();
  }
  return matrix;
}

Columns shaken(const Columns& positions, double size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> by(-size, size);
  return positions + Columns::NullaryExpr(3, positions.cols(), [&] { return by(random); });
}

TEST(NeighbourSprings, a_particle_inside_a_grid_has_24_neighbours_and_none_twice) {
  const CookedFabric fabric = cooked(sheet(8));
  std::vector<std::set<std::uint32_t>> neighbours(fabric.positions.size());
  std::size_t inside = 0;
  for (const ParticleSpring& s : fabric.springs) {
    EXPECT_TRUE(neighbours[s.a].insert(s.b).second);
    EXPECT_TRUE(neighbours[s.b].insert(s.a).second);
  }
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const gpu::vec4& x = fabric.positions[i];
    if (std::abs(x.x) > 0.26f || std::abs(x.z) > 0.26f) continue;   // within two cells of the edge
    ++inside;
    EXPECT_EQ(neighbours[i].size(), 24u);
    for (const std::uint32_t j : neighbours[i]) {
      EXPECT_LT(std::abs(fabric.positions[j].x - x.x), 2.01f / 8);
      EXPECT_LT(std::abs(fabric.positions[j].z - x.z), 2.01f / 8);
    }
  }
  EXPECT_EQ(inside, 25u);
}

TEST(NeighbourSprings, rows_hold_every_spring_at_both_of_its_ends) {
  const CookedFabric fabric = cooked(sheet(5));
  std::size_t found = 0;
  for (std::uint32_t i = 0; i < fabric.positions.size(); ++i)
    for (std::uint32_t q = fabric.spring_rows.rows[i].x; q < fabric.spring_rows.rows[i].x + fabric.spring_rows.rows[i].y; ++q) {
      const gpu::uvec4& four = fabric.spring_rows.ends[q];
      const std::uint32_t ends[] = {four.x, four.y, four.z, four.w};
      for (int c = 0; c < 4; ++c) {
        const gpu::vec4& figures = fabric.spring_rows.springs[4 * q + static_cast<std::uint32_t>(c)];
        if (figures.y == 0) {
          EXPECT_EQ(ends[c], i);   // padding
          continue;
        }
        ++found;
        const auto same = [&](const ParticleSpring& s) {
          return std::minmax(s.a, s.b) == std::minmax(i, ends[c]) && s.rest == figures.x && s.stiffness == figures.y;
        };
        EXPECT_EQ(std::count_if(fabric.springs.begin(), fabric.springs.end(), same), 1);
      }
    }
  EXPECT_EQ(found, 2 * fabric.springs.size());
}

TEST(SpringTerms, stiffness_is_the_derivative_of_the_force_for_a_stretched_spring) {
  const ImplicitSpring spring{0.5, 300, 0.2, false};
  const Vector d(0.4, -0.3, 0.6), still = Vector::Zero();
  for (int k = 0; k < 3; ++k) {
    const double step = 1e-5;
    const Vector e = step * Vector::Unit(k);
    const Vector slope = (spring_terms(spring, d + e, still).force - spring_terms(spring, d - e, still).force) / (2 * step);
    // Central differences are off by step^2 f'''/6: k / l^2 times 1e-10.
    EXPECT_LT((slope + spring_terms(spring, d, still).stiffness.col(k)).norm(), 300 / d.squaredNorm() * 1e-9);
    const Vector drag = (spring_terms(spring, d, e).force - spring_terms(spring, d, -e).force) / (2 * step);
    EXPECT_LT((drag + spring_terms(spring, d, still).damping.col(k)).norm(), 1e-9);   // linear in the velocity
  }
}

TEST(SpringTerms, a_compressed_spring_resists_along_itself_alone) {
  const Vector d(0.1, 0, 0);
  const Matrix stiffness = spring_terms({0.5, 300, 0, false}, d, Vector::Zero()).stiffness;
  EXPECT_EQ(stiffness, (Matrix() << 300, 0, 0, 0, 0, 0, 0, 0, 0).finished());
  EXPECT_TRUE(spring_terms({0.5, 300, 0, true}, d, Vector::Zero()).force.isZero(0)) << "a slack link pushed";
  EXPECT_TRUE(spring_terms({0.5, 300, 1, false}, Vector::Zero(), d).force.isZero(0)) << "ends at one place have no direction";
}

// The energy of linear springs, 1/2 k |d|^2 each, is that of the stencils.
TEST(BendingSprings, they_have_the_energy_of_the_stencils) {
  Scene scene = sheet(6);
  scene.cloths[0].springs.reset();
  const CookedFabric fabric = cooked(scene);
  Columns x(3, fabric.positions.size());
  for (Eigen::Index i = 0; i < x.cols(); ++i) x.col(i) = Vector(fabric.positions[i].x, fabric.positions[i].y, fabric.positions[i].z);
  x = shaken(x, 0.1, 1);
  double springs = 0, stencils = 0;
  for (const ParticleSpring& s : fabric.springs)
    if (s.rest == 0) springs += 0.5 * s.stiffness * (x.col(s.a) - x.col(s.b)).squaredNorm();
  for (const gpu::Bend& bend : fabric.bends) {
    const Vector l = bend_value({bend.k[0], bend.k[1], bend.k[2], bend.k[3]},
                                {x.col(bend.particle[0]), x.col(bend.particle[1]), x.col(bend.particle[2]), x.col(bend.particle[3])});
    stencils += 0.5 * l.squaredNorm() / bend.compliance;
  }
  EXPECT_NEAR(springs / stencils, 1, 1e-5);   // coefficients are floats
}

// However crumpled the pose, nothing makes the matrix indefinite, and the bound that Jacobi's weight rests on holds.
TEST(ImplicitEquations, they_are_positive_definite_and_bounded_by_their_diagonal) {
  for (const bool bending : {false, true}) {
    Scene scene = sheet(5);
    if (bending) scene.cloths[0].springs.reset();
    const CookedFabric fabric = cooked(scene);
    ImplicitSystem system = system_of(scene, fabric);
    for (const unsigned seed : {1u, 2u, 3u}) {
      system.positions = shaken(system.positions, 0.3, seed);
      const ImplicitEquations equations = system.assemble();
      const Eigen::MatrixXd matrix = dense(equations);
      EXPECT_LT((matrix - matrix.transpose()).norm(), 1e-12 * matrix.norm());
      Eigen::MatrixXd diagonal = Eigen::MatrixXd::Zero(matrix.rows(), matrix.cols());
      for (Eigen::Index i = 0; i < equations.right.cols(); ++i) diagonal.block<3, 3>(3 * i, 3 * i) = equations.diagonal[i];
      EXPECT_LT((matrix.block<3, 3>(0, 0) - diagonal.block<3, 3>(0, 0)).norm(), 1e-12 * matrix.norm());
      const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> pencil(matrix, diagonal, Eigen::EigenvaluesOnly);
      EXPECT_GT(pencil.eigenvalues().minCoeff(), 0);
      EXPECT_LT(pencil.eigenvalues().maxCoeff(), 4.0 / 3 / system.jacobi_weight) << "bending " << bending;
    }
  }
}

TEST(ConjugateGradients, they_find_the_answer_of_the_sparse_cholesky_factors) {
  const Scene scene = sheet(7);
  const CookedFabric fabric = cooked(scene);
  ImplicitSystem system = system_of(scene, fabric);
  system.positions = shaken(system.positions, 0.05, 4);
  const ImplicitEquations equations = system.assemble();
  const Eigen::SparseMatrix<double> matrix = dense(equations).sparseView();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
  const Eigen::VectorXd wanted = factors.solve(equations.right.reshaped());
  const ImplicitSolution found = solve_conjugate_gradients(equations, 1000, 1e-12);
  EXPECT_LT((found.change.reshaped() - wanted).norm(), 1e-9 * wanted.norm());   // 1e-12 times a condition below 1000
  EXPECT_LT(found.iterations, 200u);
}

// Of both solvers, in the norm in which each promises it: the A norm, and the residual's through D^-1.
TEST(LinearSolvers, every_iteration_comes_closer) {
  const Scene scene = sheet(7);
  const CookedFabric fabric = cooked(scene);
  ImplicitSystem system = system_of(scene, fabric);
  system.positions = shaken(system.positions, 0.05, 5);
  const ImplicitEquations equations = system.assemble();
  const Columns wanted = solve_conjugate_gradients(equations, 2000, 1e-14).change;
  const auto error = [&](const Columns& change) { return (change - wanted).cwiseProduct(equations.times(change - wanted)).sum(); };
  double cg = error(Columns::Zero(3, wanted.cols())), jacobi = cg;
  for (std::uint32_t iterations = 2; iterations < 40; ++iterations) {
    const double cg_now = error(solve_conjugate_gradients(equations, iterations).change);
    const double jacobi_now = error(solve_jacobi(equations, iterations, system.jacobi_weight).change);
    EXPECT_LT(cg_now, cg);
    EXPECT_LT(jacobi_now, jacobi);
    EXPECT_LT(cg_now, jacobi_now);
    cg = cg_now;
    jacobi = jacobi_now;
  }
}

TEST(LinearSolvers, jacobi_with_a_weight_that_diverges_stops_with_its_best_and_says_so) {
  const Scene scene = sheet(7);
  const CookedFabric fabric = cooked(scene);
  ImplicitSystem system = system_of(scene, fabric);
  system.positions = shaken(system.positions, 0.05, 6);
  const ImplicitEquations equations = system.assemble();
  const ImplicitSolution found = solve_jacobi(equations, 1000, 1.9);
  EXPECT_TRUE(found.stopped);
  EXPECT_LT(found.iterations, 100u);
  EXPECT_LE(found.residual, 1);
  EXPECT_FALSE(solve_jacobi(equations, 1000, system.jacobi_weight).stopped);
}

// A chain at rest under its weight and one that falls freely: after one iteration both are solved.
TEST(LinearSolvers, rest_and_free_fall_are_exact_after_one_iteration) {
  for (const Linear linear : {Linear::cg, Linear::jacobi})
    for (const bool held : {true, false}) {
      CookedFabric fabric = chain(4, 0.01, 0.125, 64, 0.5, 0.01);
      if (!held) fabric.positions[0].w = fabric.positions[1].w;
      ImplicitSystem system = system_of(implicit_scene(linear, 1), fabric);
      const double weight = 9.81f / double(fabric.positions[1].w);
      double at = 0;
      for (Eigen::Index i = 1; held && i < 4; ++i) system.positions(1, i) = at -= 0.125 + static_cast<double>(4 - i) * weight / 64;
      const Columns start = system.positions;
      system.step();
      const double fallen = held ? 0 : -9.81f * 1e-4;
      for (Eigen::Index i = held; i < 4; ++i) EXPECT_NEAR(system.positions(1, i) - start(1, i), fallen, 1e-15);
      EXPECT_LT(system.report().residual, 1e-9);
    }
}

// What the first iteration is for: without it a part of every substep's fall stays unsolved, and the sheet hangs lower and lower
// until its springs make up for that.
TEST(ImplicitSystem, a_hanging_sheet_sags_when_a_solve_that_is_stopped_early_starts_from_the_free_flight_alone) {
  Scene scene = sheet(16, Linear::cg, 5);
  scene.cloths[0].fabric.damping = 0.5;
  scene.cloths[0].grid->upright = true;
  scene.cloths[0].anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};
  const CookedFabric fabric = cooked(scene);
  double sag[2];
  for (const bool guess : {false, true}) {
    ImplicitSystem system = system_of(scene, fabric);
    const double before = system.positions.row(1).minCoeff();
    for (int k = 0; k < 150; ++k) {
      ImplicitEquations equations = system.assemble();
      if (!guess) equations.guess.setZero();
      system.move(equations, system.solve(equations));
    }
    sag[guess] = before - system.positions.row(1).minCoeff();
  }
  EXPECT_LT(4 * sag[1], sag[0]);
}

// One mass on one spring: v <- (v + h g - h k/m e) / (1 + h^2 k/m + h c/m), e <- e + h v for the extension e, exactly, because
// the spring stays on its line; at rest e = m g / k.
TEST(ImplicitSystem, a_mass_on_a_spring_follows_the_closed_form) {
  const double mass = 0.25, stiffness = 40, damping = 0.3, h = 0.01;
  const CookedFabric fabric = chain(2, mass, 0.5, stiffness, damping, h);
  ImplicitSystem system = system_of(implicit_scene(Linear::cg, 5), fabric);
  double v = 0, e = 0;
  const double k = fabric.springs[0].stiffness, c = fabric.springs[0].damping, g = 9.81f;
  for (int n = 0; n < 2000; ++n) {
    system.step();
    v = (v + h * g - h * k / mass * e) / (1 + h * h * k / mass + h * c / mass);
    e += h * v;
    ASSERT_NEAR(-system.positions(1, 1) - 0.5, e, 1e-12) << "step " << n;
  }
  EXPECT_NEAR(e, mass * g / k, 1e-6);
  EXPECT_EQ(system.report().steps, 2000u);
  EXPECT_EQ(system.report().not_converged, 0u);
}

// A chain of n masses: the j-th spring carries those below it, so the end sinks by m g / k (1 + 2 + ... + n).
TEST(ImplicitSystem, a_hanging_chain_is_as_long_as_statics_says_with_both_solvers) {
  const std::uint32_t n = 8;
  const double mass = 0.01, stiffness = 50;
  for (const Linear linear : {Linear::cg, Linear::jacobi}) {
    const CookedFabric fabric = chain(n + 1, mass, 0.1, stiffness, 0.5, 0.01);
    ImplicitSystem system = system_of(implicit_scene(linear, 20), fabric);
    for (int k = 0; k < 3000; ++k) system.step();
    EXPECT_NEAR(-system.positions(1, n), 0.1 * n + mass * 9.81 / stiffness * n * (n + 1) / 2, 1e-6);
    EXPECT_EQ(system.report().stopped, 0u);
  }
}

// However few the iterations, internal forces cancel.
TEST(ImplicitSystem, a_free_sheet_keeps_its_momentum) {
  for (const Linear linear : {Linear::cg, Linear::jacobi}) {
    Scene scene = sheet(10, linear, 4);
    scene.gravity = {0, 0, 0};
    const CookedFabric fabric = cooked(scene);
    ImplicitSystem system = system_of(scene, fabric);
    Eigen::VectorXd masses(system.positions.cols());
    for (Eigen::Index i = 0; i < masses.size(); ++i) masses[i] = 1 / double(fabric.positions[i].w);
    for (Eigen::Index i = 0; i < masses.size(); ++i) system.positions(0, i) += 0.2 * system.positions(0, i) * system.positions(0, i);
    const Vector start = system.positions * masses / masses.sum();
    double fastest = 0;
    for (int k = 0; k < 50; ++k) {
      system.step();
      fastest = std::max(fastest, system.velocities.colwise().norm().maxCoeff());
      EXPECT_LT((system.velocities * masses).norm() / masses.sum(), 1e-13 * fastest);
    }
    EXPECT_GT(fastest, 0.1);
    EXPECT_LT((system.positions * masses / masses.sum() - start).norm(), 1e-13);
  }
}

TEST(ImplicitSystem, a_sheet_in_free_fall_follows_the_integrators_closed_form) {
  Scene scene = sheet(6);
  scene.cloths[0].start.imperfection = 0;
  ImplicitSystem system = system_of(scene, cooked(scene));
  for (int k = 0; k < 100; ++k) system.step();
  // Symplectic Euler: y = h^2 g n (n + 1) / 2. The springs' rest lengths are floats, so they push by a millionth.
  for (Eigen::Index i = 0; i < system.positions.cols(); ++i) EXPECT_NEAR(system.positions(1, i), -9.81 * 1e-4 * 100 * 101 / 2, 1e-5);
}

TEST(ImplicitSystem, the_filter_keeps_held_particles_where_they_are_put_to_the_bit) {
  Scene scene = sheet(8);
  scene.cloths[0].anchors.emplace_back().corners = {Corner::low_low, Corner::high_high};
  const CookedFabric fabric = cooked(scene);
  ImplicitSystem system = system_of(scene, fabric);
  const std::uint32_t still = fabric.anchors[0].particle, driven = fabric.anchors[1].particle;
  const Vector at = system.positions.col(still);
  Vector to = system.positions.col(driven);
  for (int k = 0; k < 50; ++k) {
    to += Vector(0.0013, 0.0007, -0.0003);
    const ImplicitTarget target{driven, to};
    system.step(std::span(&target, 1));
    ASSERT_EQ(system.positions.col(still), at);
    ASSERT_EQ(system.positions.col(driven), to);
  }
  EXPECT_GT(-system.positions.row(1).minCoeff(), 0.05) << "the rest did not fall";
}

TEST(ImplicitSystem, a_sheet_that_falls_on_a_plane_lies_on_it_and_can_be_lifted_off) {
  Scene scene = sheet(8);
  scene.cloths[0].transform.translate = {0, 0.05f, 0};
  scene.cloths[0].anchors.emplace_back().corners = {Corner::low_low};
  scene.colliders.emplace_back();
  const CookedFabric fabric = cooked(scene);
  ImplicitSystem system = system_of(scene, fabric);
  const std::uint32_t driven = fabric.anchors[0].particle;
  const float thickness = static_cast<float>(scene.cloths[0].fabric.thickness);
  const Vector corner = system.positions.col(driven);
  ImplicitTarget target{driven, Vector(corner.x(), thickness, corner.z())};
  for (int k = 0; k < 200; ++k) {
    system.step(std::span(&target, 1));
    ASSERT_GT(system.positions.row(1).minCoeff(), thickness - 1e-4) << "step " << k;
  }
  EXPECT_LT(system.positions.row(1).maxCoeff(), thickness + 1e-3);
  for (int k = 0; k < 300; ++k) {
    target.position.y() += 0.01;
    system.step(std::span(&target, 1));
  }
  EXPECT_GT(system.positions.row(1).minCoeff(), 0.5) << "the plane held the sheet";
}

// The fabric's own links and bends, hung by two corners.
Scene hung_on_levels(std::uint32_t cells) {
  Scene scene = implicit_scene(Linear::cg, 100);
  scene.solver.levels = true;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{2, 2}, cells, cells, Topology::diagonal, true};
  cloth.tethers = false;
  cloth.anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};
  return scene;
}

// Half a second after it was let go, when it hangs.
TEST(ImplicitSystem, ten_iterations_on_levels_leave_less_than_thirty_without) {
  for (const std::uint32_t cells : {24u, 48u}) {
    const Scene scene = hung_on_levels(cells);
    ImplicitSystem system = system_of(scene, cooked(scene));
    for (int k = 0; k < 50; ++k) system.step();
    ImplicitEquations on_levels = system.assemble(), without = on_levels;
    ASSERT_NE(on_levels.levels, nullptr);
    without.levels = nullptr;
    const Columns exact = solve_conjugate_gradients(on_levels, 1000, 1e-12).change;
    EXPECT_LT((solve_conjugate_gradients(without, 3000, 1e-12).change - exact).norm(), 1e-8 * exact.norm()) << "they solve something else";
    const auto error = [&](const ImplicitEquations& equations, std::uint32_t iterations) {
      const Columns off = solve_conjugate_gradients(equations, iterations).change - exact;
      return std::sqrt(off.cwiseProduct(equations.times(off)).sum());
    };
    EXPECT_LT(error(on_levels, 10), error(without, 30)) << cells << " cells";
    EXPECT_LT(error(on_levels, 50), 0.4 * error(without, 50)) << cells << " cells";
  }
}

// In a flat sheet at rest, by its definition: the trace of a node's diagonal block of P^T K P.
TEST(ImplicitSystem, a_levels_nodes_are_as_stiff_as_the_springs_make_them) {
  Scene scene = hung_on_levels(20);
  scene.cloths[0].bending = false;
  const CookedFabric fabric = cooked(scene);
  const LevelLists& lists = fabric.own.of<LevelLists>();
  const std::size_t levels = lists.ends.size(), particles = fabric.positions.size();
  ASSERT_GE(levels, 2u);
  const auto column_of = [&](std::uint32_t node) {   // shares of all particles in it
    std::vector<double> of_nodes(lists.nodes.size()), shares(particles);
    of_nodes[node] = 1;
    const auto carried = [&](const gpu::uvec4& packed) {
      if (packed.x == WEFT_NONE) return 0.0;
      const gpu::LevelShare share = gpu::unpack_level_share(packed);
      return double(share.part0) * of_nodes[share.node0] + double(share.part1) * of_nodes[share.node1] +
             double(share.part2) * of_nodes[share.node2];
    };
    for (std::uint32_t k = node + 1; k < lists.ends.back(); ++k) of_nodes[k] += carried(lists.node_shares[k]);
    for (std::size_t i = 0; i < particles; ++i) shares[i] = carried(lists.shares[i]);
    return shares;
  };
  std::vector<Matrix> blocks(particles, Matrix::Zero());
  for (const ParticleSpring& s : fabric.springs) {
    blocks[s.a](0, 0) += double(s.stiffness);   // only the trace counts
    blocks[s.b](0, 0) += double(s.stiffness);
  }
  const auto twin = ImplicitLevels::create(fabric);
  ASSERT_NE(twin, nullptr);
  const std::vector<Matrix> means = twin->means_of({blocks, blocks}).springs;
  const std::vector<float>& grips = fabric.own.of<weft::ImplicitLevels>().grips;
  int held = 0;
  for (std::uint32_t k = 0; k < lists.ends.back(); ++k) {
    const double inverse_mass = double(gpu::unpack_level_node(lists.nodes[k]).inverse_mass);
    if (grips[k] < 0) {
      EXPECT_EQ(inverse_mass, 0);
      ++held;
      continue;
    }
    const std::vector<double> shares = column_of(k);
    double wanted = 0;
    for (const ParticleSpring& s : fabric.springs) wanted += double(s.stiffness) * std::pow(shares[s.a] - shares[s.b], 2);
    EXPECT_NEAR(double(grips[k]) / inverse_mass * means[k].trace(), wanted, 1e-5 * wanted) << k;
  }
  EXPECT_GE(held, 2) << "the corners";
}

TEST(ImplicitSystem, what_it_cannot_do_is_refused_by_a_sentence) {
  Scene scene = sheet(2);
  scene.colliders.emplace_back().shape = ColliderShape::sphere;
  const auto refused = ImplicitSystem::create(scene, cooked(scene));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("colliders[0]"), std::string::npos);
  Scene rigid = sheet(2);
  rigid.cloths[0].springs.reset();
  rigid.cloths[0].fabric.stretch = INFINITY;
  EXPECT_NE(cook(rigid, *make_meshes(rigid)).error().find("rigid"), std::string::npos);
  Scene other = sheet(2);
  other.solver.method = Method::jacobi;
  EXPECT_NE(cook(other, *make_meshes(other)).error().find("springs"), std::string::npos);
  Scene levels = sheet(2, Linear::jacobi);
  levels.solver.levels = true;
  EXPECT_NE(cook(levels, *make_meshes(levels)).error().find("with linear \"cg\""), std::string::npos);
}

}  // namespace
}  // namespace weft::reference
