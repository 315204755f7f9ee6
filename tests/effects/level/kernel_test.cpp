// The passes of coarse levels against their twin.
#include <gtest/gtest.h>

#include "engine/effects/level/level.h"
#include "shaders/level/level.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"
#include "tests/support/supports.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using KernelLevel = GpuTest;

reference::Share share_of(gpu::uvec4 packed, std::uint32_t first) {
  const gpu::LevelShare share = gpu::unpack_level_share(packed);
  return {{share.node0 - first, share.node1 - first, share.node2 - first}, {share.part0, share.part1, share.part2}};
}

// Coarsest first, each with its own numbers of nodes.
std::vector<reference::Level> levels_of(const LevelLists& lists) {
  std::vector<reference::Level> levels;
  std::uint32_t first = 0, first_of_coarser = 0;
  for (const std::uint32_t end : lists.ends) {
    reference::Level& level = levels.emplace_back();
    for (std::uint32_t k = first; k < end; ++k) {
      const gpu::LevelNode node = gpu::unpack_level_node(lists.nodes[k]);
      auto& gathers = level.gathers.emplace_back();
      double in_centre = 1, in_middle = 1;   // the first point's weights are what the others leave
      for (std::uint32_t g = node.first_gather; g < gpu::unpack_level_node(lists.nodes[k + 1]).first_gather; ++g) {
        const gpu::LevelGather gather = gpu::unpack_level_gather(lists.gathers[g]);
        gathers.push_back({gather.point - (end == lists.ends.back() ? 0 : end), gather.in_centre, gather.in_middle});
        if (g == node.first_gather) continue;
        in_centre -= gather.in_centre;
        in_middle -= gather.in_middle;
      }
      gathers[0].in_centre = in_centre;
      gathers[0].in_middle = in_middle;
      level.inverse_masses.push_back(node.inverse_mass);
      if (lists.node_shares[k].x != WEFT_NONE) level.shares.push_back(share_of(lists.node_shares[k], first_of_coarser));
      for (std::uint32_t l = node.first_link; l < node.first_link + node.links; ++l) {
        const gpu::LevelLink link = gpu::unpack_level_link(lists.links[l]);
        if (link.other > k) level.links.push_back({k - first, link.other - first, link.rest, link.compliance, true});
      }
    }
    first_of_coarser = first;
    first = end;
  }
  return levels;
}

struct Crumple {
  Scene scene = without_contacts();
  CookedFabric fabric;
};

Crumple crumple(std::uint32_t cells, std::uint32_t iterations, double stretch, Random& random, bool supported = false) {
  Crumple c;
  c.scene.solver = {.rate = 600, .substeps = 1, .iterations = iterations, .method = Method::jacobi, .relaxation = iterations > 1 ? 1.4 : 1.1, .levels = true};
  Cloth& cloth = c.scene.cloths.emplace_back();
  cloth.grid = Grid{.size = {1, 1}, .cells_x = cells, .cells_y = cells - 3};
  cloth.tethers = cloth.bending = false;
  cloth.fabric.stretch = stretch;
  cloth.anchors.emplace_back().corners = {Corner::low_low, Corner::high_high};
  c.fabric = must(cook(c.scene, must(make_meshes(c.scene))));
  if (supported) let_colliders_hold(c.scene, c.fabric);
  // Stretched by a tenth, so that links of all levels pull, and crumpled.
  for (gpu::vec4& x : c.fabric.positions) {
    const gpu::vec4 d = anywhere(random, 0.01, 0);
    x = {1.1f * x.x + d.x, 1.1f * x.y + d.y, 1.1f * x.z + d.z, x.w};
  }
  return c;
}

TEST_F(KernelLevel, low_and_wide_levels_and_their_spreading_do_what_their_twin_does) {
  Random random(21);
  for (const std::uint32_t cells : {24u, 150u})
    for (const std::uint32_t iterations : {1u, 3u})
      for (const double stretch : {1e3, std::numeric_limits<double>::infinity()})
        for (const auto& [storage, driven, supported] :
             {std::tuple(false, false, false), {true, false, false}, {false, true, false}, {false, false, true}, {true, false, true}}) {
          if (cells == 150 && iterations == 1 && storage) continue;   // every other way is tried there
          SCOPED_TRACE(std::to_string(cells) + " cells, " + std::to_string(iterations) + " iterations, " + std::to_string(stretch) + " N/m" +
                       (driven ? ", driven" : "") + (supported ? ", supported" : ""));
          const Crumple c = crumple(cells, iterations, stretch, random, supported);
          const LevelLists& lists = c.fabric.own.of<LevelLists>();
          const auto levels = levels_of(lists);
          ASSERT_GE(levels.size(), 2u);
          ASSERT_EQ(lists.low < lists.ends.size(), cells == 150) << "a level of more than " << WEFT_LOW_LEVEL << " nodes is wide";
          SinglePass passes(device(), c.scene, c.fabric, storage);
          passes.put_iterate(c.fabric.positions);
          FrameInput input = frame_of(1);
          input.is_driven = driven;
          passes.begin(input);
          reference::Supports supports;
          if (supported) supports = put_supports(passes, random, c.fabric);
          reference::Points twin = points(c.fabric.positions);
          std::vector<std::vector<double>> lambdas;
          for (const reference::Level& level : levels) lambdas.emplace_back(level.links.size());
          for (int iteration = 0; iteration < static_cast<int>(iterations); ++iteration) {
            passes.run("level_centre", iteration);
            for (std::size_t wide = lists.low; wide + 1 < levels.size(); ++wide)
              passes.run("level_centre_wide", iteration * static_cast<int>(levels.size() - lists.low - 1) + static_cast<int>(wide - lists.low));
            passes.run("level_low", iteration);
            for (std::size_t wide = lists.low; wide < levels.size(); ++wide)
              passes.run("level_wide", iteration * static_cast<int>(levels.size() - lists.low) + static_cast<int>(wide - lists.low));
            passes.run("level_spread", iteration);
            std::vector<reference::Points> centres(levels.size()), middles(levels.size());
            std::vector<reference::Supports> of_nodes(levels.size());
            for (std::size_t k = levels.size(); k-- > 0;) {
              const bool finest = k + 1 == levels.size();
              centres[k] = reference::means(levels[k], finest ? twin : centres[k + 1], &reference::Gather::in_centre);
              middles[k] = reference::means(levels[k], finest ? twin : middles[k + 1], &reference::Gather::in_middle);
              if (!supported) continue;
              const auto& finer = finest ? supports : of_nodes[k + 1];
              of_nodes[k] = {reference::means(levels[k], finer.put_out, &reference::Gather::in_centre), std::vector<double>(levels[k].gathers.size())};
            }
            reference::Points steps;
            double moved = 0;
            for (std::size_t k = 0; k < levels.size(); ++k) {
              steps = reference::level_steps(levels[k], centres[k], middles[k], steps, lambdas[k], c.fabric.h,
                                             std::min(WEFT_EAGER_LEVELS * c.scene.solver.relaxation, double(WEFT_MOST_EAGER)),
                                             driven ? WEFT_LEVEL_KEPT : 0,
                                             supported ? &of_nodes[k] : nullptr, k > 0 ? of_nodes[k - 1].held : std::span<const double>());
              for (const reference::Vector& step : steps) moved = std::max(moved, step.norm());
            }
            EXPECT_GT(moved, 1e-4) << "nothing to compare";
            const std::uint32_t first = lists.ends.size() > 1 ? lists.ends[lists.ends.size() - 2] : 0;
            for (std::size_t i = 0; i < twin.size(); ++i) {
              if (lists.shares[i].x == WEFT_NONE) continue;
              const reference::Share share = share_of(lists.shares[i], first);
              const reference::Vector step = reference::carried(share, steps);
              twin[i] += supported ? supports.move(i, step) : step;
              if (supported) supports.held[i] += reference::carried_held(share, of_nodes.back().held) * supports.put_out[i].norm();
            }
          }
          if (supported) { EXPECT_LT(largest_gap_of_held(passes, supports), 40 * kRounding * 1.6 * iterations * static_cast<double>(levels.size())); }
          // Rounding, on lengths up to 1.6 m, of each level on top of those before.
          EXPECT_LT(largest_gap(passes.iterate(), twin), 40 * kRounding * 1.6 * iterations * static_cast<double>(levels.size()));
        }
}

TEST_F(KernelLevel, a_particle_that_is_not_finite_spoils_no_node) {
  Random random(22);
  Crumple c = crumple(24, 1, 1e3, random);
  const LevelLists& lists = c.fabric.own.of<LevelLists>();
  const std::uint32_t spoilt = lists.gathers.back().x;
  SinglePass passes(device(), c.scene, c.fabric);
  auto iterate = c.fabric.positions;
  iterate[spoilt].y = NAN;
  passes.put_iterate(iterate);
  passes.begin(frame_of(1));
  for (const char* pass : {"level_centre", "level_low", "level_spread"}) passes.run(pass);
  const auto steps = passes.get<gpu::vec4>(buffers::level_steps, lists.ends.back());
  for (const gpu::vec4& step : steps) EXPECT_TRUE(std::isfinite(step.x + step.y + step.z));
  const auto after = passes.iterate();
  for (std::uint32_t i = 0; i < after.size(); ++i) EXPECT_EQ(std::isfinite(after[i].y), i != spoilt);
}

}  // namespace
}  // namespace weft
