// The hard cases (samples/weft/hard_cases.h): the small ones run here, each within its bounds; and the list itself is complete. It
// names the case or test that shows each of the README's thirteen families and of the earlier systems' failures F1 to F17.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <set>
#include <sstream>

#include "samples/weft/drape_measure.h"
#include "samples/weft/hard_run.h"
#include "samples/weft/hardening.h"
#include "tests/support/gpu_fixture.h"

namespace weft::command {

static void PrintTo(const HardCase& hard, std::ostream* out) { *out << hard.name; }

namespace {

namespace fs = std::filesystem;

const fs::path kScenes = WEFT_ASSETS "/scenes/hard";

class HardCases : public GpuTest, public testing::WithParamInterface<HardCase> {};

TEST_P(HardCases, stays_within_its_bounds) {
  const HardCase& hard = GetParam();
  const Scene scene = must(scene_of(hard, kScenes));
  const std::vector<double> figures = must(measure(device(), hard, scene));
  for (std::size_t k = 0; k < figures.size(); ++k)
    EXPECT_LE(figures[k], hard.checks[k].bound) << hard.checks[k].what << ", " << hard.checks[k].unit;
}

std::vector<HardCase> small_cases() {
  std::vector<HardCase> small;
  std::copy_if(hard_cases().begin(), hard_cases().end(), std::back_inserter(small), [](const HardCase& hard) { return !hard.large; });
  return small;
}

INSTANTIATE_TEST_SUITE_P(Small, HardCases, testing::ValuesIn(small_cases()), [](const auto& info) {
  std::string name(info.param.name);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

// A sheet that is held in its middle third: flat, with its free ring hanging straight down, and with half of it turned over onto the rest.
TEST(DrapeMeasure, flat_cloth_stands_out_whole_and_what_hangs_down_not_at_all) {
  Scene scene;
  scene.cloths.emplace_back().grid = Grid{{0.3f, 0.3f}, 30, 30, Topology::diagonal, false};
  scene.cloths[0].anchors.emplace_back().box = Anchor::Box{{-0.051f, -1, -0.051f}, {0.051f, 1, 0.051f}};
  scene.cloths[0].start.imperfection = 0;
  const CookedFabric fabric = must(cook(scene, must(make_meshes(scene))));
  const auto coefficient = [&](auto place) {
    std::vector<gpu::vec4> positions = fabric.positions;
    for (gpu::vec4& p : positions) place(p);
    return drape_coefficient(fabric, fabric.cloths[0], fabric.positions, positions).value();
  };
  EXPECT_NEAR(coefficient([](gpu::vec4&) {}), 1, 1e-9);
  const auto hang = [](gpu::vec4& p) { p.x = std::clamp(p.x, -0.05f, 0.05f), p.z = std::clamp(p.z, -0.05f, 0.05f); };
  EXPECT_NEAR(coefficient(hang), 0, 0.02);
  EXPECT_NEAR(coefficient([](gpu::vec4& p) { p.x = std::min(p.x, 0.1f - p.x); }), (0.3 * 0.2 - 0.01) / 0.08, 0.02);
}

// Family 11: what the physics is invariant under changes nothing: the mean within 2 % of the sheet's size, the shape within 4 %.
class Perturbed : public GpuTest {};

TEST_F(Perturbed, no_rate_mass_size_place_start_or_hitch_changes_how_a_sheet_hangs) {
  const Scene scene = must(load_scene(kScenes / "invariance.json"));
  const PerturbedRun base = must(run_perturbed(device(), scene, {}, scene.frames));
  for (const Perturbation& perturbation : all_perturbations(scene, true)) {
    const PerturbedRun seen = must(run_perturbed(device(), scene, perturbation, scene.frames));
    for (const std::string& fault : broken(perturbation, seen, base, 0.02)) ADD_FAILURE() << perturbation.name << ": " << fault;
    if (perturbation.hitch > 0) { EXPECT_NEAR(seen.clamped, perturbation.hitch - scene.solver.longest_advance, 1e-9); }
  }
}

TEST_F(Perturbed, no_mass_changes_how_a_sheet_hangs_that_nothing_stretches) {
  const Scene scene = must(load_scene(kScenes / "invariance_rigid.json"));
  const PerturbedRun base = must(run_perturbed(device(), scene, {}, scene.frames));
  for (const Perturbation& perturbation : all_perturbations(scene, true)) {
    if (perturbation.weight == 1) continue;
    EXPECT_EQ(perturbation.bands, 1);
    const PerturbedRun seen = must(run_perturbed(device(), scene, perturbation, scene.frames));
    for (const std::string& fault : broken(perturbation, seen, base, 0.02)) ADD_FAILURE() << perturbation.name << ": " << fault;
  }
}

TEST(HardCaseList, every_family_and_every_failure_is_shown_by_a_case_or_a_test) {
  std::set<std::string> shown;
  for (const HardCase& hard : hard_cases()) {
    std::istringstream families{std::string(hard.families)};
    for (std::string family; families >> family;) shown.insert(family);
  }
  for (const TestedBy& tested : tested_by()) shown.insert(std::string(tested.family));
  for (int k = 1; k <= 12; ++k) EXPECT_TRUE(shown.contains(std::to_string(k))) << k;   // 13 is F1 to F17
  for (int k = 1; k <= 17; ++k) {
    std::string failure = "F";
    failure += std::to_string(k);
    if (k != 16) { EXPECT_TRUE(shown.contains(failure)) << failure; }
  }
}

TEST(HardCaseList, every_scene_is_of_a_case_and_tells_what_it_shows) {
  std::set<std::string> used = {"invariance", "invariance_rigid"}, names;
  for (const HardCase& hard : hard_cases()) {
    used.insert(std::string(hard.scene));
    EXPECT_TRUE(names.insert(std::string(hard.name)).second) << hard.name;
  }
  std::set<std::string> there;
  for (const auto& entry : fs::directory_iterator(kScenes))
    if (entry.path().extension() == ".json") {
      there.insert(entry.path().stem().string());
      const auto scene = load_scene(entry.path());
      ASSERT_TRUE(scene) << entry.path() << ": " << scene.error();
      EXPECT_GT(scene->description.size(), 20u) << entry.path();
    }
  EXPECT_EQ(there, used);
}

TEST(HardCaseList, every_test_that_it_names_exists) {
  std::string sources;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(WEFT_SOURCE_DIR) / "tests"))
    if (entry.path().extension() == ".cpp") {
      std::ifstream stream(entry.path(), std::ios::binary);
      sources.append(std::istreambuf_iterator<char>(stream), {});
    }
  for (const TestedBy& tested : tested_by()) {
    std::string declared(tested.test);
    declared.replace(declared.find('.'), 1, ", ");
    EXPECT_NE(sources.find("(" + declared + ")"), std::string::npos) << tested.test;
  }
}

}  // namespace
}  // namespace weft::command
