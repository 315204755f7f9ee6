// The implicit passes against their twin in double precision (engine/reference/implicit.h): the equations of crumpled sheets, their
// product with a vector, and whole solves after a few iterations and after many.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/effects/implicit/columns.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using reference::Columns;
using reference::ImplicitEquations;

// A sheet of 9 x 11 vertices, its particles anywhere within 5 cm of where they rest and moving; two corners are held. `links`: with
// the springs of a fabric, which only pull in part and bend, instead of 24 neighbours.
struct CrumpledSprings {
  Scene scene = without_contacts();
  CookedFabric fabric;
  ImplicitEquations equations;

  CrumpledSprings(Linear linear, std::uint32_t iterations, bool links, unsigned seed, std::uint32_t cells_on_levels = 0) {
    const bool levels = cells_on_levels > 0;
    scene.solver = {.rate = 100, .substeps = 1, .iterations = iterations, .method = Method::implicit, .linear = linear, .levels = levels};
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{0.8f, 1}, 8, 10, Topology::diagonal, true};
    if (levels) cloth.grid = Grid{{1, 1}, cells_on_levels, cells_on_levels, Topology::diagonal, true};
    cloth.tethers = false;
    cloth.fabric.stretch = 200;
    if (!links) cloth.springs = Springs{{500, 0.02}, {400, 0.01}, {50, 0.001}};
    cloth.anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};
    fabric = must(cook(scene, must(make_meshes(scene))));
    Random random(seed);
    fabric.positions = moved(random, fabric, levels ? 0.3 / cells_on_levels : 0.05);
    for (gpu::vec4& v : fabric.velocities) v = anywhere(random, 0.5, v.w);
    for (const AnchorTarget& anchor : fabric.anchors) fabric.velocities[anchor.particle] = {0, 0, 0, fabric.velocities[anchor.particle].w};
    reference::ImplicitSystem system = must(reference::ImplicitSystem::create(scene, fabric));
    equations = system.assemble();
  }

  // What predict leaves behind, and then the passes of a substep up to the last iteration.
  SinglePass passes(const compute::Device& device, bool gather_storage, std::uint32_t workgroup = 64) const {
    SinglePass passes(device, scene, fabric, gather_storage, workgroup);
    std::vector<gpu::vec4> flight = fabric.velocities;
    for (std::size_t i = 0; i < flight.size(); ++i) {
      const auto v = equations.flight.col(static_cast<Eigen::Index>(i));
      flight[i] = {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), flight[i].w};
    }
    passes.put(buffers::velocities, flight);
    FrameInput input = frame_of(1);
    input.gravity = scene.gravity;
    passes.begin(input);
    passes.run("implicit_assemble");
    return passes;
  }
};

using KernelImplicit = GpuTest;

TEST_F(KernelImplicit, assemble_makes_the_equations_of_its_twin) {
  for (const bool links : {false, true})
    for (const bool gather_storage : {false, true})
      for (const unsigned seed : {1u, 2u}) {
        const CrumpledSprings sheet(Linear::cg, 1, links, seed);
        const SinglePass passes = sheet.passes(device(), gather_storage);
        const std::size_t n = sheet.fabric.positions.size();
        const Columns right = columns(passes.get<gpu::vec4>(buffers::solve_vectors, n), 0, n);
        EXPECT_LT(largest(right - sheet.equations.right), kSummed * largest(sheet.equations.right)) << "links " << links;
        const Columns guess = columns(passes.get<gpu::vec4>(buffers::exchanged, n), 0, n);
        EXPECT_LT(largest(guess - sheet.equations.guess), 16 * kRounding) << "of velocities up to 1 m/s";
        const auto inverses = passes.get<gpu::vec4>(buffers::inverses, 2 * n);
        for (std::size_t i = 0; i < n; ++i) {
          const gpu::vec4 &d = inverses[2 * i], &b = inverses[2 * i + 1];
          const reference::Matrix c = (reference::Matrix() << d.x, 0, 0, b.x, d.y, 0, b.y, b.z, d.z).finished();
          const reference::Matrix& wanted = sheet.equations.inverse[i];
          // The factor of a block is as exact as its condition, below 100 here, allows.
          EXPECT_LE((c.transpose() * c - wanted).norm(), 100 * kSummed * wanted.norm()) << i;
          EXPECT_EQ(d.w > 0, sheet.fabric.positions[i].w > 0);
        }
      }
}

TEST_F(KernelImplicit, multiply_is_the_product_with_the_twins_matrix) {
  for (const bool links : {false, true})
    for (const bool gather_storage : {false, true})
      for (const std::uint32_t workgroup : {24u, 64u}) {
        const CrumpledSprings sheet(Linear::cg, 1, links, 3);
        SinglePass passes = sheet.passes(device(), gather_storage, workgroup);
        Random random(7);
        const std::size_t n = sheet.fabric.positions.size();
        std::vector<gpu::vec4> z;
        for (const gpu::vec4& x : sheet.fabric.positions) z.push_back(x.w == 0 ? gpu::vec4{0, 0, 0, 0} : anywhere(random, 1, 0));
        passes.put(buffers::exchanged, z);
        passes.run("implicit_multiply");
        const Columns wanted = sheet.equations.filtered(sheet.equations.times(columns(z, 0, n)));
        const Columns got = columns(passes.get<gpu::vec4>(buffers::solve_vectors, 3 * n), 2 * n, n);
        EXPECT_LT(largest(got - wanted), kSummed * largest(wanted));
        double residual = 0, curvature = 0, squared = 0;
        for (const gpu::vec4& sums : passes.get<gpu::vec4>(buffers::partial_sums, (n + workgroup - 1) / workgroup)) {
          residual += sums.x;
          curvature += sums.y;
          squared += sums.z;
        }
        const Columns& b = sheet.equations.right;
        double norm = 0;
        for (Eigen::Index i = 0; i < b.cols(); ++i) norm += b.col(i).dot(sheet.equations.inverse[static_cast<std::size_t>(i)] * b.col(i));
        EXPECT_NEAR(residual, b.cwiseProduct(columns(z, 0, n)).sum(), kSummed * b.norm() * columns(z, 0, n).norm());
        EXPECT_NEAR(curvature, wanted.cwiseProduct(columns(z, 0, n)).sum(), kSummed * wanted.norm() * columns(z, 0, n).norm());
        EXPECT_NEAR(squared / norm, 1, kSummed);
      }
}

// The change after so many iterations, on both sides.
struct Solved {
  Columns got, wanted;
  gpu::Counters counters;
};
Solved solve(const compute::Device& device, const CrumpledSprings& sheet, bool gather_storage) {
  SinglePass passes = sheet.passes(device, gather_storage);
  const std::uint32_t iterations = sheet.scene.solver.iterations;
  const bool jacobi = sheet.scene.solver.linear == Linear::jacobi;
  const std::vector<gpu::vec4> before = passes.iterate();
  for (std::uint32_t k = 0; k < iterations; ++k) {
    const int dispatch = static_cast<int>(k);
    if (jacobi) passes.run("implicit_relax", dispatch);
    else iterate_gradients(passes, dispatch, sheet.fabric);
  }
  const std::size_t n = before.size();
  Solved solved;
  if (jacobi) solved.got = columns(passes.get<gpu::vec4>(buffers::exchanged, 3 * n), n * ((iterations - 1) % 3), n);
  else solved.got = columns(passes.get<gpu::vec4>(buffers::solve_vectors, 2 * n), n, n);
  solved.wanted = (jacobi ? reference::solve_jacobi(sheet.equations, iterations, sheet.fabric.jacobi_weight)
                          : reference::solve_conjugate_gradients(sheet.equations, iterations)).change;
  passes.run("implicit_step");
  solved.counters = passes.counters();
  return solved;
}

// Rounding errors of an iteration go into all that follow; conjugate gradients turn them into other directions of search, so that a
// few hundred of them show in the fourth digit before they are caught up with.
TEST_F(KernelImplicit, a_solve_goes_where_its_twin_goes) {
  for (const Linear linear : {Linear::cg, Linear::jacobi})
    for (const bool links : {false, true})
      for (const bool gather_storage : {false, true})
        for (const std::uint32_t iterations : {2u, 3u, 5u, 40u}) {
          const CrumpledSprings sheet(linear, iterations, links, 4);
          const Solved solved = solve(device(), sheet, gather_storage);
          EXPECT_LT((solved.got - solved.wanted).norm(), 1e-3 * solved.wanted.norm())
              << (linear == Linear::cg ? "cg " : "jacobi ") << iterations << " iterations, links " << links;
          EXPECT_EQ(solved.counters.stopped, 0u);
        }
}

TEST_F(KernelImplicit, a_solve_on_levels_goes_where_its_twin_goes) {
  for (const std::uint32_t cells : {12u, 30u, 110u})
    for (const bool links : {false, true})
      for (const bool gather_storage : {false, true})
        for (const std::uint32_t iterations : {2u, 3u, 20u}) {
          if (cells == 110 && (iterations != 3 || links == gather_storage)) continue;   // every other way is tried there
          SCOPED_TRACE(std::to_string(cells) + " cells, " + std::to_string(iterations) + " iterations, links " + std::to_string(links));
          const CrumpledSprings sheet(Linear::cg, iterations, links, 8, cells);
          const LevelLists& lists = sheet.fabric.own.of<LevelLists>();
          ASSERT_GE(lists.ends.size(), cells == 12 ? 1u : 2u);
          ASSERT_EQ(lists.low < lists.ends.size(), cells == 110) << "a level of more than " << WEFT_LOW_LEVEL << " nodes is wide";
          const Solved solved = solve(device(), sheet, gather_storage);
          EXPECT_LT((solved.got - solved.wanted).norm(), 1e-3 * solved.wanted.norm());
          EXPECT_EQ(solved.counters.stopped, 0u);
          ImplicitEquations without = sheet.equations;
          without.levels = nullptr;
          const Columns by_blocks = reference::solve_conjugate_gradients(without, iterations).change;
          EXPECT_GT((by_blocks - solved.wanted).norm(), 0.01 * solved.wanted.norm()) << "levels change nothing";
        }
}

TEST_F(KernelImplicit, a_solve_with_many_iterations_is_exact_to_rounding_and_says_so) {
  for (const bool links : {false, true}) {
    const CrumpledSprings sheet(Linear::cg, 300, links, 5);
    const Solved solved = solve(device(), sheet, false);
    const Columns exact = reference::solve_conjugate_gradients(sheet.equations, 2000, 1e-13).change;
    // A condition below 1000 times the rounding of the right side.
    EXPECT_LT((solved.got - exact).norm(), 1000 * 24 * kRounding * exact.norm());
    EXPECT_EQ(solved.counters.unconverged, 0u);
    EXPECT_LT(solved.counters.residual, 1e-5);
    const CrumpledSprings hasty(Linear::jacobi, 3, links, 5);
    const Solved early = solve(device(), hasty, false);
    EXPECT_EQ(early.counters.unconverged, 1u);
    EXPECT_GT(early.counters.residual, WEFT_CONVERGED);
  }
}

// With this weight Jacobi diverges: it must rest with the iterate before the residual grew, as its twin does.
TEST_F(KernelImplicit, jacobi_that_diverges_is_broken_off_with_its_best_iterate) {
  CrumpledSprings sheet(Linear::jacobi, 60, false, 6);
  sheet.fabric.jacobi_weight = 1.9;
  SinglePass passes = sheet.passes(device(), false);
  for (int k = 0; k < 60; ++k) passes.run("implicit_relax", k);
  const auto before = passes.iterate();
  passes.run("implicit_step");
  EXPECT_EQ(passes.counters().stopped, 1u);
  const reference::ImplicitSolution twin = reference::solve_jacobi(sheet.equations, 60, 1.9);
  ASSERT_TRUE(twin.stopped);
  // Positions after the substep: p = x + h (v* + dv).
  const auto after = passes.particles(buffers::positions);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const reference::Vector wanted =
        vector(before[i]) +
        (sheet.fabric.positions[i].w == 0 ? reference::Vector::Zero() : reference::Vector(sheet.fabric.h * twin.change.col(column)));
    EXPECT_LT((vector(after[i]) - wanted).norm(), 1e-4 * sheet.fabric.h * twin.change.colwise().norm().maxCoeff() + 4 * kRounding) << i;
  }
}

}  // namespace
}  // namespace weft
