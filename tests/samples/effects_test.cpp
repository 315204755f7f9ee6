// The engine simulates only what a scene calls for: each effect of the list that `weft effects` prices, off, alone, and with each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "engine/effects/effect.h"
#include "engine/fabric.h"
#include "engine/metrics.h"
#include "engine/reference/intersections.h"
#include "samples/weft/effect_rows.h"
#include "samples/weft/footprint.h"
#include "tests/support/gpu_fixture.h"

namespace weft::command {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kCells = 6;
constexpr int kFrames = 6;   // the sheet reaches all bodies

class Effects : public GpuTest {
 protected:
  fs::path folder = fs::temp_directory_path() / ("weft_effects_test_" + std::to_string(std::random_device{}()));
  void SetUp() override {
    GpuTest::SetUp();
    fs::create_directories(folder);
    ASSERT_TRUE(write_body(folder));
  }
  void TearDown() override {
    fs::remove_all(folder);
    GpuTest::TearDown();
  }
  Result<Scene> scene_with(std::span<const Assignment> assignments) const { return base_scene(kCells, folder, assignments); }
};

// What a run leaves.
struct Left {
  Footprint footprint;
  std::uint64_t hash = 0;
  std::uint32_t lost = 0, non_finite = 0, contacts = 0;
  std::size_t crossings = 0;
  bool operator==(const Left&) const = default;
};

Left left_by(const compute::Device& device, const Scene& scene) {
  const auto simulation = must(Simulation::create(device, scene));
  Left left;
  for (int k = 0; k < kFrames; ++k) left.lost += must(simulation->advance(1 / scene.solver.rate)).pairs_lost;
  const auto positions = must(simulation->read_positions());
  std::vector<Vec3> places;
  for (const gpu::vec4& p : positions) {
    places.push_back({p.x, p.y, p.z});
    left.non_finite += !std::isfinite(p.x + p.y + p.z);
  }
  left.non_finite += simulation->counts().non_finite;
  left.contacts = simulation->counts().contacts_most;
  left.footprint = footprint_of(*simulation);
  left.hash = position_hash(positions);
  const CookedFabric& fabric = simulation->fabric();
  if (contacts_on(scene)) left.crossings = count_crossings(places, fabric.triangles, fabric.cloth_triangles);
  return left;
}

TEST_F(Effects, every_effect_has_a_row) {
  std::bitset<kEffects> called;
  for (const EffectRow& row : effect_rows()) {
    const Scene scene = must(scene_with(row.on));
    const CookedFabric fabric = must(cook(scene, must(make_meshes(scene))));
    called |= needs_of(cooked_of(scene, fabric), 64, true).effects;
  }
  for (const Effect* effect : all_effects())
    EXPECT_TRUE(called[static_cast<std::size_t>(std::find(all_effects().begin(), all_effects().end(), effect) - all_effects().begin())])
        << effect->name << " is in no row of samples/weft/effect_rows.cpp";
}

TEST_F(Effects, one_that_is_off_leaves_no_pass_dispatch_byte_or_instruction_and_changes_no_bit) {
  const Left base = left_by(device(), must(scene_with({})));
  EXPECT_GT(base.footprint.instructions, 0u);
  for (const EffectRow& row : effect_rows()) {
    const Left off = left_by(device(), must(scene_with(row.off)));
    EXPECT_EQ(off, base) << row.name << ": " << off.footprint.passes << " passes, " << off.footprint.dispatches << " dispatches, "
                         << off.footprint.bytes << " bytes, " << off.footprint.instructions << " instructions; the base has "
                         << base.footprint.passes << ", " << base.footprint.dispatches << ", " << base.footprint.bytes << ", "
                         << base.footprint.instructions;
    EXPECT_NE(footprint_of(*must(Simulation::create(device(), must(scene_with(row.on))))), base.footprint) << row.name << " is on";
  }
}

// By the first effect: each is a test of its own.
class EffectPairs : public Effects, public testing::WithParamInterface<std::size_t> {};

TEST_P(EffectPairs, runs_with_each_later_one_or_is_refused_by_a_sentence) {
  const EffectRow& first = effect_rows()[GetParam()];
  for (const EffectRow& second : effect_rows().subspan(GetParam() + 1)) {
    SCOPED_TRACE(std::string(first.name) + " + " + second.name);
    const auto both = both_of(first, second);
    const Result<Scene> scene = both ? scene_with(*both) : Result<Scene>(both.why());
    if (!scene) {
      // It names a key that one of the two gives.
      bool names_a_key = false;
      for (const EffectRow* row : {&first, &second})
        for (const Assignment& given : row->on) names_a_key |= scene.error().starts_with(given.path + ": ");
      EXPECT_TRUE(names_a_key) << scene.error();
      continue;
    }
    const Left left = left_by(device(), *scene);
    EXPECT_EQ(left.non_finite, 0u);
    EXPECT_EQ(left.lost, 0u);
    EXPECT_EQ(left.crossings, 0u);
    EXPECT_EQ(left.contacts > 0, contacts_on(*scene));
    EXPECT_EQ(left_by(device(), *scene), left) << "a second run";
  }
}

INSTANTIATE_TEST_SUITE_P(Every, EffectPairs, testing::Range<std::size_t>(0, effect_rows().size() - 1),
                         [](const auto& info) { return std::string(effect_rows()[info.param].name); });

}  // namespace
}  // namespace weft::command
