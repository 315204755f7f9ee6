// A round of strands against its twin: a sweep of Gauss-Seidel.
#include <gtest/gtest.h>

#include "engine/effects/strand/strand.h"
#include "shaders/stretch/stretch.ref.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"
#include "tests/support/supports.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using KernelStrand = GpuTest;

struct Crush {
  Scene scene = without_contacts();
  CookedFabric fabric;
};

Crush crush(std::uint32_t iterations, double stretch, Random& random, bool supported = false) {
  Crush c;
  c.scene.solver = {.rate = 600, .substeps = 1, .iterations = iterations, .method = Method::strands, .levels = false};
  Cloth& cloth = c.scene.cloths.emplace_back();
  cloth.grid = Grid{.size = {1, 1}, .cells_x = 30, .cells_y = 21};
  cloth.tethers = cloth.bending = false;
  cloth.fabric.stretch = stretch;
  cloth.anchors.emplace_back().corners = {Corner::low_low, Corner::high_high};
  c.fabric = must(cook(c.scene, must(make_meshes(c.scene))));
  if (supported) let_colliders_hold(c.scene, c.fabric);
  for (gpu::vec4& x : c.fabric.positions) {
    const gpu::vec4 d = anywhere(random, 0.03, 0);
    x = {x.x + d.x, x.y + d.y, x.z + d.z, x.w};
  }
  return c;
}

// Strand after strand: they share no particle. With one iteration links come with their gain, in 8 bits of mantissa: the twin gets the
// compliance that makes it so.
std::vector<reference::Stretch> links_of(const Crush& c, const Range& round) {
  const StrandLists& lists = c.fabric.own.of<StrandLists>();
  std::vector<reference::Stretch> links;
  for (std::uint32_t s = 0; s < round.count; ++s) {
    std::uint32_t from = lists.starts[round.first + s];
    for (std::uint32_t k = 0; k < WEFT_STRAND_LINKS; ++k) {
      const gpu::uvec2 packed = lists.links[WEFT_STRAND_LINKS * round.first + k * round.count + s];
      const gpu::Link link = gpu::unpack_link(packed.x, packed.y);
      if (link.rest == 0) break;
      double compliance = link.response;
      if (c.scene.solver.iterations == 1 && link.response > 0) {
        const double weight = double(c.fabric.positions[from].w) + c.fabric.positions[link.other].w;
        compliance = c.fabric.h * c.fabric.h * (1.0 / link.response - weight);
      }
      links.push_back({from, link.other, link.rest, compliance, link.only_pulls});
      from = link.other;
    }
  }
  return links;
}

TEST_F(KernelStrand, a_round_does_what_its_twin_does) {
  Random random(31);
  for (const std::uint32_t iterations : {1u, 3u})
    for (const double stretch : {1e3, std::numeric_limits<double>::infinity()})
      for (const auto& [storage, supported] : {std::pair(false, false), {true, false}, {false, true}, {true, true}}) {
        SCOPED_TRACE(supported ? "supported" : "not supported");
        const Crush c = crush(iterations, stretch, random, supported);
        const StrandLists& lists = c.fabric.own.of<StrandLists>();
        const auto rounds = static_cast<int>(lists.rounds.size());
        std::vector<std::vector<reference::Stretch>> links;
        std::vector<std::vector<double>> lambdas;
        for (const Range& round : lists.rounds) lambdas.emplace_back(links.emplace_back(links_of(c, round)).size());
        SinglePass passes(device(), c.scene, c.fabric, storage);
        passes.put_iterate(c.fabric.positions);
        passes.begin(frame_of(1));
        reference::Supports supports;
        if (supported) supports = put_supports(passes, random, c.fabric);
        reference::Points twin = points(c.fabric.positions);
        const auto masses = inverse_masses(c.fabric);
        for (int k = 0; k < static_cast<int>(iterations); ++k)
          for (int round = 0; round < rounds; ++round) {
            passes.run("strand", k * rounds + round);
            reference::sweep_stretch(links[round], twin, masses, lambdas[round], c.fabric.h, 1, supported ? &supports : nullptr);
          }
        // Rounding, on lengths up to 1.5 m; each link of a strand sees the errors of those before.
        EXPECT_LT(largest_gap(passes.iterate(), twin), 10 * kRounding * 1.5 * iterations * rounds * WEFT_STRAND_LINKS)
            << iterations << " iterations, " << stretch << " N/m";
        EXPECT_EQ(passes.counters().coincident, 0u);
        if (supported) { EXPECT_LT(largest_gap_of_held(passes, supports), 10 * kRounding * 1.5 * iterations * rounds * WEFT_STRAND_LINKS); }
      }
}

TEST_F(KernelStrand, ends_at_one_place_are_parted_and_what_is_not_finite_stays_alone) {
  Random random(32);
  Crush c = crush(1, 1e3, random);
  const StrandLists& lists = c.fabric.own.of<StrandLists>();
  const std::uint32_t a = lists.starts[0], b = gpu::unpack_link(lists.links[0].x, lists.links[0].y).other;
  const std::uint32_t spoilt = gpu::unpack_link(lists.links[3].x, lists.links[3].y).other;   // of the fourth strand
  auto iterate = c.fabric.positions;
  iterate[b] = {iterate[a].x, iterate[a].y, iterate[a].z, iterate[b].w};
  iterate[spoilt].x = NAN;
  SinglePass passes(device(), c.scene, c.fabric);
  passes.put_iterate(iterate);
  passes.begin(frame_of(1));
  passes.run("strand");
  EXPECT_EQ(passes.counters().coincident, 1u);
  const auto after = passes.iterate();
  EXPECT_GT((vector(after[a]) - vector(after[b])).norm(), 1e-3);
  for (std::uint32_t i = 0; i < after.size(); ++i) EXPECT_EQ(std::isfinite(after[i].x), i != spoilt) << i;
}

}  // namespace
}  // namespace weft
