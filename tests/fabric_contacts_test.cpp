// What the cook makes for contacts: edges, rest poses, and mesh colliders.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/fabric.h"

namespace weft {
namespace {

Scene two_sheets() {
  Scene scene;
  for (const double thickness : {0.002, 0.005}) {
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{1, 2}, 5, 7, Topology::diagonal, false};
    cloth.fabric.thickness = thickness;
  }
  scene.cloths[1].transform.translate = {0, 1, 0};
  scene.contacts.enabled = true;
  return scene;
}

CookedFabric cooked(const Scene& scene) {
  const auto meshes = make_meshes(scene);
  EXPECT_TRUE(meshes) << meshes.error();
  if (!meshes) return {};
  auto fabric = cook(scene, *meshes);
  EXPECT_TRUE(fabric) << fabric.error();
  return fabric ? std::move(*fabric) : CookedFabric{};
}

using Pair = std::pair<std::uint32_t, std::uint32_t>;

TEST(FabricContacts, every_edge_of_every_triangle_is_there_once_with_its_lower_particle_first) {
  const CookedFabric fabric = cooked(two_sheets());
  std::set<Pair> wanted;
  for (const Triangle& t : fabric.triangles)
    for (int k = 0; k < 3; ++k) wanted.insert(std::minmax(t[k], t[(k + 1) % 3]));
  // Sheets of 5 x 7 cells: 5 x 8 + 6 x 7 sides and 35 diagonals each.
  ASSERT_EQ(fabric.edges.size(), 2u * (40 + 42 + 35));
  EXPECT_TRUE(std::equal(fabric.edges.begin(), fabric.edges.end(), wanted.begin(), wanted.end(),
                         [](gpu::uvec2 edge, const Pair& pair) { return edge.x == pair.first && edge.y == pair.second; }));
}

TEST(FabricContacts, rest_is_where_a_particle_starts_with_the_thickness_of_its_cloth) {
  const CookedFabric fabric = cooked(two_sheets());
  ASSERT_EQ(fabric.rest.size(), fabric.positions.size());
  for (std::size_t i = 0; i < fabric.rest.size(); ++i) {
    const gpu::vec4 &rest = fabric.rest[i], &x = fabric.positions[i];
    EXPECT_TRUE(rest.x == x.x && rest.y == x.y && rest.z == x.z);
    EXPECT_EQ(rest.w, i < fabric.cloths[1].first_particle ? 0.002f : 0.005f);
  }
}

TEST(FabricContacts, the_mean_edge_is_that_of_all_edges) {
  const CookedFabric fabric = cooked(two_sheets());
  const double x = 0.2, z = 2.0 / 7;
  EXPECT_NEAR(fabric.mean_edge, (40 * x + 42 * z + 35 * std::hypot(x, z)) / 117, 1e-7);   // of single precision
}

TEST(FabricContacts, without_contacts_there_is_nothing_but_the_number_of_triangles) {
  Scene scene = two_sheets();
  scene.contacts.enabled = false;
  const CookedFabric fabric = cooked(scene);
  EXPECT_TRUE(fabric.edges.empty());
  EXPECT_TRUE(fabric.rest.empty());
  EXPECT_EQ(fabric.mean_edge, 0);
  EXPECT_EQ(fabric.cloth_triangles, 2u * 70);
}

}  // namespace
}  // namespace weft
