// Strands: which links they are.
#include <gtest/gtest.h>

#include <set>

#include "engine/effects/strand/strand.h"
#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

CookedFabric stranded(const Grid& grid, Method method = Method::strands) {
  Scene scene = without_contacts();
  scene.solver.method = method;
  scene.cloths.emplace_back().grid = grid;
  return cooked(scene);
}

// Of each round, its strands as particles.
std::vector<std::vector<std::vector<std::uint32_t>>> rounds_of(const CookedFabric& fabric) {
  const StrandLists& lists = fabric.own.of<StrandLists>();
  std::vector<std::vector<std::vector<std::uint32_t>>> rounds;
  for (const Range& round : lists.rounds) {
    auto& strands = rounds.emplace_back();
    for (std::uint32_t s = 0; s < round.count; ++s) {
      auto& strand = strands.emplace_back();
      strand.push_back(lists.starts[round.first + s]);
      for (std::uint32_t k = 0; k < WEFT_STRAND_LINKS; ++k) {
        const gpu::uvec2 packed = lists.links[WEFT_STRAND_LINKS * round.first + k * round.count + s];
        const gpu::Link link = gpu::unpack_link(packed.x, packed.y);
        if (link.rest == 0) break;
        strand.push_back(link.other);
      }
    }
  }
  return rounds;
}

const Grid kStrandGrids[] = {
    {{1, 1}, 40, 30, Topology::diagonal, true}, {{1, 1}, 23, 31, Topology::centre, false}, {{1, 1}, 1, 1}, {{1, 0.1f}, 50, 1}};

TEST(Strands, those_of_a_round_share_no_particle_and_have_all_of_them) {
  for (const Grid& grid : kStrandGrids) {
    const CookedFabric fabric = stranded(grid);
    const auto rounds = rounds_of(fabric);
    ASSERT_EQ(rounds.size(), 2u);
    for (const auto& strands : rounds) {
      std::set<std::uint32_t> seen;
      for (const auto& strand : strands)
        for (const std::uint32_t i : strand) EXPECT_TRUE(seen.insert(i).second) << i;
      EXPECT_EQ(seen.size(), fabric.positions.size());
    }
  }
}

TEST(Strands, a_link_is_in_one_or_left_to_jacobi) {
  for (const Grid& grid : kStrandGrids) {
    const CookedFabric fabric = stranded(grid);
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> in_strands, marked, gathered;
    for (const auto& strands : rounds_of(fabric))
      for (const auto& strand : strands)
        for (std::size_t k = 1; k < strand.size(); ++k) in_strands.insert(std::minmax(strand[k - 1], strand[k]));
    std::size_t left = 0;
    for (const StretchLink& link : fabric.links) {
      if (link.in_strand) marked.insert(std::minmax(link.a, link.b));
      else ++left;
    }
    EXPECT_EQ(in_strands, marked);
    std::size_t entries = 0;
    for (const gpu::uvec2& row : fabric.stretch.rows) entries += row.y;
    EXPECT_EQ(entries, 2 * left);
  }
}

// On a grid both threads of the weave, all but the links between pieces.
TEST(Strands, they_follow_warp_and_weft) {
  const CookedFabric fabric = stranded({{1, 1}, 64, 64, Topology::diagonal, true});
  const auto rounds = rounds_of(fabric);
  for (std::size_t r = 0; r < rounds.size(); ++r) {
    std::size_t links = 0;
    for (const auto& strand : rounds[r]) {
      EXPECT_LE(strand.size(), WEFT_STRAND_LINKS + 1);
      EXPECT_GE(strand.size(), WEFT_STRAND_LINKS / 2) << "pieces are even";
      for (std::size_t k = 1; k < strand.size(); ++k) {
        const gpu::vec4 &a = fabric.positions[strand[k - 1]], &b = fabric.positions[strand[k]];
        EXPECT_NEAR(r == 0 ? a.y - b.y : a.x - b.x, 0, 1e-6) << "warp is along x, weft along y";
      }
      links += strand.size() - 1;
    }
    EXPECT_GE(links, 65u * 60u);
  }
}

TEST(Strands, only_the_method_strands_has_them) {
  EXPECT_TRUE(stranded(kStrandGrids[0], Method::jacobi).own.of<StrandLists>().starts.empty());
  EXPECT_TRUE(stranded(kStrandGrids[0], Method::gauss_seidel).own.of<StrandLists>().starts.empty());
}

}  // namespace
}  // namespace weft
