// Solvers other than Jacobi against their twins: a sweep of Gauss-Seidel through its patches, and substeps of Chebyshev's iteration.
#include <gtest/gtest.h>

#include "engine/effects/gauss_seidel/gauss_seidel.h"
#include "shaders/chebyshev/chebyshev.ref.h"
#include "shaders/bend/bend.ref.h"
#include "shaders/gauss_seidel/gauss_seidel.ref.h"
#include "shaders/stretch/stretch.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"
#include "tests/support/supports.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using KernelSweep = GpuTest;

struct CrumpledPatches {
  Scene scene = without_contacts();
  CookedFabric fabric;
};

CrumpledPatches crumpled(std::uint32_t iterations, double stretch, Random& random, Method method = Method::gauss_seidel,
                         std::uint32_t cells = 14, bool supported = false) {
  CrumpledPatches c;
  c.scene.solver = {.rate = 600, .substeps = 1, .iterations = iterations, .method = method, .relaxation = 1.1};
  Cloth& cloth = c.scene.cloths.emplace_back();
  cloth.grid = Grid{.size = {1, 1}, .cells_x = cells, .cells_y = 11};
  cloth.bending = method == Method::chebyshev;
  cloth.tethers = false;
  cloth.fabric.stretch = stretch;
  cloth.anchors.emplace_back().corners = {Corner::low_low, Corner::high_high};
  const auto meshes = must(make_meshes(c.scene));
  c.fabric = must(cook(c.scene, meshes));
  if (supported) let_colliders_hold(c.scene, c.fabric);
  for (gpu::vec4& x : c.fabric.positions) {
    const gpu::vec4 d = anywhere(random, 0.03, 0);
    x = {x.x + d.x, x.y + d.y, x.z + d.z, x.w};
  }
  return c;
}

// The links of a round's patches, patch after patch and colour after colour: patches share no particle, so that their order is free.
std::vector<reference::Stretch> links_of(const PatchLists& lists, const Range& round) {
  std::vector<reference::Stretch> links;
  for (std::uint32_t p = round.first; p < round.first + round.count; ++p) {
    const gpu::Patch& patch = lists.patches[p];
    const std::uint32_t end = lists.colour_ends[patch.first_colour + patch.colours];
    for (std::uint32_t k = lists.colour_ends[patch.first_colour]; k < end; ++k) {
      const gpu::PatchLink link = gpu::unpack_patch_link(lists.links[k]);
      links.push_back({lists.members[patch.first_member + link.a], lists.members[patch.first_member + link.b], link.rest, link.compliance,
                       link.only_pulls});
    }
  }
  return links;
}

std::span<const std::uint32_t> members_of(const PatchLists& lists, std::uint32_t patch) {
  return std::span(lists.members).subspan(lists.patches[patch].first_member, lists.patches[patch].members);
}

TEST_F(KernelSweep, a_sweep_through_the_patches_does_what_its_twin_does) {
  Random random(11);
  for (const std::uint32_t cells : {14u, 60u})
    for (const std::uint32_t iterations : {1u, 3u})
      for (const auto& [stretch, supported] : {std::pair(1e3, false), {std::numeric_limits<double>::infinity(), false}, {1e3, true}}) {
        SCOPED_TRACE(supported ? "supported" : "not supported");
        const CrumpledPatches c = crumpled(iterations, stretch, random, Method::gauss_seidel, cells, supported);
        const PatchLists& lists = c.fabric.own.of<PatchLists>();
        const auto rounds = static_cast<int>(lists.rounds.size());
        std::vector<std::vector<reference::Stretch>> links;
        std::vector<std::vector<double>> lambdas;
        std::uint32_t most_colours = 0;
        for (const Range& round : lists.rounds) {
          links.push_back(links_of(lists, round));
          lambdas.emplace_back(links.back().size());
        }
        for (const gpu::Patch& patch : lists.patches) most_colours = std::max(most_colours, patch.colours);
        SinglePass passes(device(), c.scene, c.fabric, iterations == 3);
        passes.put_iterate(c.fabric.positions);
        passes.begin(frame_of(1));
        reference::Supports supports;
        if (supported) supports = put_supports(passes, random, c.fabric);
        const reference::Points x = points(c.fabric.positions);
        reference::Points twin = x;
        const auto masses = inverse_masses(c.fabric);
        for (int k = 0; k < static_cast<int>(iterations); ++k)
          for (int round = 0; round < rounds; ++round) {
            passes.run("gauss_seidel", k * rounds + round);
            const reference::Points before = twin;
            reference::sweep_stretch(links[round], twin, masses, lambdas[round], c.fabric.h, c.scene.solver.relaxation,
                                     supported ? &supports : nullptr);
            for (std::uint32_t p = lists.rounds[round].first; p < lists.rounds[round].first + lists.rounds[round].count; ++p)
              if (!supported || !holds_any(supports, members_of(lists, p))) reference::turn_back(members_of(lists, p), x, before, twin, masses);
          }
        // Rounding, on lengths up to 1.5 m; each colour sees the errors of those before.
        EXPECT_LT(largest_gap(passes.iterate(), twin), 40 * kRounding * 1.5 * iterations * rounds * most_colours)
            << cells << " cells, " << iterations << " iterations, " << stretch << " N/m";
        EXPECT_EQ(passes.counters().coincident, 0u);
        if (supported) { EXPECT_LT(largest_gap_of_held(passes, supports), 40 * kRounding * 1.5 * iterations * rounds * most_colours); }
      }
}

// Particles are elsewhere than where the substep began, as after coarse levels or another patch's round: then impulses along links turn a
// patch. Seen by the sums over each free patch.
TEST_F(KernelSweep, a_sweep_changes_neither_momentum_nor_angular_momentum_of_a_free_patch) {
  Random random(13);
  const CrumpledPatches c = crumpled(1, 1e3, random, Method::gauss_seidel, 60);
  const PatchLists& lists = c.fabric.own.of<PatchLists>();
  const auto masses = inverse_masses(c.fabric);
  const reference::Points x = points(c.fabric.positions);
  auto moved = c.fabric.positions;
  for (gpu::vec4& p : moved) {
    const gpu::vec4 d = anywhere(random, 0.02, 0);
    if (p.w > 0) p = {p.x + d.x + 0.1f * p.z, p.y + d.y, p.z + d.z, p.w};
  }
  const reference::Points before = points(moved);
  reference::Points swept = before;
  const auto links = links_of(lists, lists.rounds[0]);
  std::vector<double> lambda(links.size());
  reference::sweep_stretch(links, swept, masses, lambda, c.fabric.h, c.scene.solver.relaxation);
  SinglePass passes(device(), c.scene, c.fabric, false);
  passes.put_iterate(moved);
  passes.begin(frame_of(1));
  passes.run("gauss_seidel", 0);
  const reference::Points after = points(passes.iterate());
  int free = 0;
  for (std::uint32_t p = 0; p < lists.rounds[0].count; ++p) {
    const auto members = members_of(lists, p);
    if (std::ranges::any_of(members, [&](std::uint32_t i) { return masses[i] == 0; })) continue;
    ++free;
    reference::Vector momentum = reference::Vector::Zero();
    double all = 0;   // kg m, of all motion
    for (const std::uint32_t i : members) momentum += (after[i] - before[i]) / masses[i], all += (after[i] - before[i]).norm() / masses[i];
    EXPECT_LT(momentum.norm(), 1e-5 * all) << "patch " << p;
    const double turned = reference::turned_by(members, x, before, after, masses).norm();
    EXPECT_LT(turned, 0.01 * reference::turned_by(members, x, before, swept, masses).norm()) << "patch " << p;
  }
  EXPECT_GT(free, 0);
}

// From rest, without gravity: the prediction is the pose itself.
reference::Points chebyshev_substep(const Scene& scene, const CookedFabric& fabric) {
  const SolverSettings& solver = scene.solver;
  std::vector<reference::Stretch> links;
  for (const StretchLink& link : fabric.links) links.push_back({link.a, link.b, link.rest, link.compliance, link.only_pulls});
  std::vector<reference::Bend> bends;
  for (const gpu::Bend& b : fabric.bends)
    bends.push_back({{b.particle[0], b.particle[1], b.particle[2], b.particle[3]}, {b.k[0], b.k[1], b.k[2], b.k[3]}, b.compliance});
  const auto masses = inverse_masses(fabric);
  reference::Points newer = points(fabric.positions), older = newer;
  std::vector<double> lambda(links.size()), older_lambda = lambda;
  std::vector<reference::Vector> bending(bends.size(), reference::Vector::Zero()), older_bending = bending;
  for (const double weight : reference::chebyshev_weights(rho_of(solver), solver.iterations)) {
    std::uint32_t skipped = 0;
    auto jacobi_lambda = lambda;
    auto jacobi_bending = bending;
    auto jacobi = reference::relax_stretch(links, newer, masses, jacobi_lambda, fabric.h, relaxation_of(scene),
                                           reference::Averaged::mass_split, skipped);
    jacobi = reference::relax_bend(bends, jacobi, masses, jacobi_bending, fabric.h, relaxation_of(scene), reference::Averaged::mass_split);
    for (std::size_t i = 0; i < newer.size(); ++i) older[i] = reference::extrapolated(older[i], jacobi[i], weight);
    for (std::size_t e = 0; e < links.size(); ++e) {
      older_lambda[e] = reference::extrapolated(older_lambda[e], jacobi_lambda[e], weight);
      if (links[e].only_pulls) older_lambda[e] = std::min(older_lambda[e], 0.0);
    }
    for (std::size_t e = 0; e < bends.size(); ++e) older_bending[e] = reference::extrapolated(older_bending[e], jacobi_bending[e], weight);
    std::swap(older, newer);
    std::swap(older_lambda, lambda);
    std::swap(older_bending, bending);
  }
  return newer;
}

TEST_F(KernelSweep, a_substep_of_chebyshev_does_what_its_twin_does) {
  Random random(12);
  for (const std::uint32_t iterations : {2u, 5u})
    for (const double stretch : {1e3, std::numeric_limits<double>::infinity()}) {
      CrumpledPatches c = crumpled(iterations, stretch, random, Method::chebyshev);
      c.scene.gravity = {0, 0, 0};
      SinglePass passes(device(), c.scene, c.fabric, iterations == 5);
      passes.begin(frame_of(1));
      passes.run("predict");
      for (int k = 0; k < static_cast<int>(iterations); ++k)
        for (const char* pass : {"stretch", "bend_lambda", "bend_gather", "chebyshev"}) passes.run(pass, k);
      // Rounding, on lengths up to 1.5 m, carried on with weights below 2.
      EXPECT_LT(largest_gap(passes.particles(buffers::positions), chebyshev_substep(c.scene, c.fabric)),
                40 * kRounding * 1.5 * 2 * iterations * iterations)
          << iterations << " iterations, " << stretch << " N/m";
      EXPECT_EQ(passes.counters().unaccelerated, 0u);
    }
}

}  // namespace
}  // namespace weft
