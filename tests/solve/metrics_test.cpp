// Figures about a state: strain of a known stretch, and a hash that sees one bit.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "engine/metrics.h"
#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

CookedFabric strip() {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{2, 1}, 12, 6, Topology::diagonal, true};
  return cooked(scene);
}

// Rest lengths are packed with a relative error of 8e-6.
constexpr double kPacked = 1e-5;

TEST(Metrics, a_sheet_at_rest_has_no_strain) {
  const CookedFabric fabric = strip();
  EXPECT_LT(measure_strain(fabric, fabric.positions).max, kPacked);
}

TEST(Metrics, an_evenly_scaled_sheet_has_one_strain_everywhere) {
  const CookedFabric fabric = strip();
  for (const float scale : {1.1f, 0.9f}) {
    auto positions = fabric.positions;
    for (gpu::vec4& p : positions) p = {scale * p.x, scale * p.y, scale * p.z, p.w};
    const Strain strain = measure_strain(fabric, positions);
    EXPECT_NEAR(strain.mean, 0.1, kPacked);
    EXPECT_NEAR(strain.rms, 0.1, kPacked);
    EXPECT_NEAR(strain.max, 0.1, kPacked);
    for (const float s : vertex_strain(fabric, positions)) EXPECT_NEAR(s, 0.1, kPacked);
  }
}

// Of n squares stretched along x: 12 x 7 edges by 0.2, 13 x 6 not at all, 72 diagonals by sqrt((1.2^2 + 1) / 2) - 1.
TEST(Metrics, an_unevenly_stretched_sheet_has_its_mean_and_largest_strain) {
  const CookedFabric fabric = strip();
  auto positions = fabric.positions;
  for (gpu::vec4& p : positions) p.x *= 1.2f;
  const double diagonal = std::sqrt((1.2 * 1.2 + 1) / 2) - 1, count = 84 + 78 + 72;
  const Strain strain = measure_strain(fabric, positions);
  EXPECT_NEAR(strain.max, 0.2, kPacked);
  EXPECT_NEAR(strain.mean, (84 * 0.2 + 72 * diagonal) / count, kPacked);
  EXPECT_NEAR(strain.rms, std::sqrt((84 * 0.04 + 72 * diagonal * diagonal) / count), kPacked);
}

TEST(Metrics, strain_is_shown_at_the_vertices_of_the_link) {
  const CookedFabric fabric = strip();
  auto positions = fabric.positions;
  const std::uint32_t moved = fabric.surface_rows[0].x;
  positions[moved].z += 0.5f;
  const auto strains = vertex_strain(fabric, positions);
  ASSERT_EQ(strains.size(), fabric.surface_rows.size());
  EXPECT_GT(strains[0], 1);
  EXPECT_GT(strains[1], 1);
  EXPECT_LT(strains.back(), kPacked);
}

TEST(Metrics, the_hash_differs_on_one_bit_and_not_on_the_inverse_mass) {
  const std::vector<gpu::vec4> positions = strip().positions;
  const std::uint64_t hash = position_hash(positions);
  EXPECT_EQ(position_hash(positions), hash);
  for (int bit = 0; bit < 32; ++bit) {
    auto changed = positions;
    changed[40].y = std::bit_cast<float>(std::bit_cast<std::uint32_t>(changed[40].y) ^ (1u << bit));
    EXPECT_NE(position_hash(changed), hash) << bit;
  }
  auto heavier = positions;
  heavier[40].w *= 2;
  EXPECT_EQ(position_hash(heavier), hash);
  auto swapped = positions;
  std::swap(swapped[0], swapped[1]);
  EXPECT_NE(position_hash(swapped), hash);
}

}  // namespace
}  // namespace weft
