// Patches and their colours: what Gauss-Seidel may move at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "engine/effects/gauss_seidel/gauss_seidel.h"
#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

CookedFabric patched(Topology topology, std::uint32_t cells, std::vector<Corner> corners, bool levels = false) {
  Scene scene = without_contacts();
  scene.solver.method = Method::gauss_seidel;
  scene.solver.levels = levels;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, cells, cells, topology, true};
  if (!corners.empty()) cloth.anchors.emplace_back().corners = std::move(corners);
  return cooked(scene);
}

const PatchLists& lists_of(const CookedFabric& fabric) { return fabric.own.of<PatchLists>(); }

// Calls visit(patch, colour, a, b, link) for every link, ends as particles.
template <class Visit>
void for_every_link(const CookedFabric& fabric, const Range& round, Visit visit) {
  const PatchLists& lists = lists_of(fabric);
  for (std::uint32_t p = round.first; p < round.first + round.count; ++p) {
    const gpu::Patch& patch = lists.patches[p];
    for (std::uint32_t c = 0; c < patch.colours; ++c)
      for (std::uint32_t k = lists.colour_ends[patch.first_colour + c]; k < lists.colour_ends[patch.first_colour + c + 1]; ++k) {
        const gpu::PatchLink link = gpu::unpack_patch_link(lists.links[k]);
        visit(p, c, lists.members[patch.first_member + link.a], lists.members[patch.first_member + link.b], link);
      }
  }
}

TEST(Patches, those_of_a_round_share_no_particle_nor_do_links_of_a_colour) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    const CookedFabric fabric = patched(topology, 40, {Corner::low_high});
    const PatchLists& lists = lists_of(fabric);
    ASSERT_GT(lists.rounds.size(), 1u);
    for (const Range& round : lists.rounds) {
      std::set<std::uint32_t> members;
      for (std::uint32_t p = round.first; p < round.first + round.count; ++p) {
        EXPECT_LE(lists.patches[p].members, WEFT_PATCH);
        for (std::uint32_t m = 0; m < lists.patches[p].members; ++m)
          EXPECT_TRUE(members.insert(lists.members[lists.patches[p].first_member + m]).second);
      }
      std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> moved;
      for_every_link(fabric, round, [&](std::uint32_t patch, std::uint32_t colour, std::uint32_t a, std::uint32_t b, const gpu::PatchLink&) {
        EXPECT_TRUE(moved.insert({patch, colour, a}).second && moved.insert({patch, colour, b}).second);
      });
    }
  }
}

TEST(Patches, every_link_that_can_move_somebody_is_in_one_as_the_cook_made_it) {
  const CookedFabric fabric = patched(Topology::diagonal, 24, {Corner::low_low, Corner::high_low, Corner::low_high, Corner::high_high});
  using Key = std::tuple<std::uint32_t, std::uint32_t, float, float, bool>;
  std::multiset<Key> cooked, found;
  for (const StretchLink& link : fabric.links)
    if (fabric.positions[link.a].w > 0 || fabric.positions[link.b].w > 0)
      cooked.insert({link.a, link.b, link.rest, link.own_compliance(), link.only_pulls});
  for (const Range& round : lists_of(fabric).rounds)
    for_every_link(fabric, round, [&](std::uint32_t, std::uint32_t, std::uint32_t a, std::uint32_t b, const gpu::PatchLink& link) {
      found.insert({a, b, link.rest, link.compliance, link.only_pulls});
    });
  EXPECT_EQ(found, cooked);
}

// Every round is a dispatch. Far links reach from patch to patch, and coarse levels come in their place.
TEST(Patches, their_rounds_are_few) {
  EXPECT_LE(lists_of(patched(Topology::diagonal, 99, {})).rounds.size(), 4u);
  EXPECT_LE(lists_of(patched(Topology::centre, 60, {})).rounds.size(), 4u);
  EXPECT_LE(lists_of(patched(Topology::diagonal, 99, {}, true)).rounds.size(), 3u);
  EXPECT_LE(lists_of(patched(Topology::centre, 60, {}, true)).rounds.size(), 3u);
  EXPECT_EQ(lists_of(patched(Topology::diagonal, 14, {}, true)).rounds.size(), 1u) << "225 particles are one patch";
}

// Which is the default for cloth that has coarse levels and no contacts.
TEST(Patches, only_gauss_seidel_has_them) {
  Scene scene = without_contacts();
  scene.cloths.emplace_back().grid = Grid{};
  EXPECT_FALSE(lists_of(cooked(scene)).patches.empty());
  scene.contacts.enabled = true;
  EXPECT_TRUE(lists_of(cooked(scene)).patches.empty());
  scene.contacts.enabled = false;
  scene.solver.levels = false;
  EXPECT_TRUE(lists_of(cooked(scene)).patches.empty());
  scene.solver.levels = {};
  scene.solver.method = Method::jacobi;
  EXPECT_TRUE(lists_of(cooked(scene)).patches.empty());
}

}  // namespace
}  // namespace weft
