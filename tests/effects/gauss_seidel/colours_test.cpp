// Colours: what Gauss-Seidel may move at once.
#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "tests/support/cooked.h"

namespace weft {
namespace {

CookedFabric coloured(Topology topology, std::uint32_t cells, std::vector<Corner> corners) {
  Scene scene;
  scene.solver.method = Method::gauss_seidel;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, cells, cells, topology, true};
  if (!corners.empty()) cloth.anchors.emplace_back().corners = std::move(corners);
  return cooked(scene);
}

TEST(Colours, no_two_links_of_one_share_a_particle) {
  for (const Topology topology : {Topology::diagonal, Topology::centre}) {
    const CookedFabric fabric = coloured(topology, 24, {Corner::low_high});
    for (std::uint32_t colour = 0, k = 0; colour < fabric.colour_ends.size(); ++colour) {
      std::set<std::uint32_t> moved;
      for (; k < fabric.colour_ends[colour]; ++k) {
        const gpu::ColouredLink link = gpu::unpack_coloured(fabric.coloured_links[k]);
        EXPECT_TRUE(moved.insert(link.a).second && moved.insert(link.b).second) << "colour " << colour << ", link " << k;
      }
    }
    EXPECT_EQ(fabric.colour_ends.back(), fabric.coloured_links.size());
  }
}

TEST(Colours, every_link_that_can_move_somebody_has_one_as_the_cook_made_it) {
  const CookedFabric fabric = coloured(Topology::diagonal, 12, {Corner::low_low, Corner::high_low, Corner::low_high, Corner::high_high});
  using Key = std::tuple<std::uint32_t, std::uint32_t, float, float, bool>;
  std::set<Key> cooked, found;
  for (const StretchLink& link : fabric.links)
    if (fabric.positions[link.a].w > 0 || fabric.positions[link.b].w > 0)
      cooked.insert({link.a, link.b, link.rest, link.compliance, link.only_pulls});
  for (const gpu::uvec4& packed : fabric.coloured_links) {
    const gpu::ColouredLink link = gpu::unpack_coloured(packed);
    found.insert({link.a, link.b, link.rest, link.compliance, link.only_pulls});
  }
  EXPECT_EQ(found, cooked);
  EXPECT_EQ(found.size(), fabric.coloured_links.size());
}

// Every colour is a dispatch. Inside a grid with one diagonal a particle has 12 links: 8 to its neighbours and 4 far ones.
TEST(Colours, they_are_few) {
  EXPECT_LE(coloured(Topology::diagonal, 64, {}).colour_ends.size(), 14u);
  EXPECT_LE(coloured(Topology::centre, 40, {}).colour_ends.size(), 18u);
}

TEST(Colours, only_gauss_seidel_has_them) {
  Scene scene;
  scene.cloths.emplace_back().grid = Grid{};
  const auto meshes = make_meshes(scene);
  EXPECT_TRUE(cook(scene, *meshes)->coloured_links.empty());
}

}  // namespace
}  // namespace weft
