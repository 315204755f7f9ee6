// Still frames: where no detection has been due for long, `advance` records none, and repeats a frame in which one was asked for. The bits
// are those of frames that are submitted, which cannot be repeated and have all passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/printing.h"
#include "tests/support/sheets.h"

namespace weft {
namespace {

using Still = GpuTest;

constexpr int kStillFrames = 80, kBlown = 60;   // the frame in which gravity turns

// Hangs, and swings until the air has stopped it.
Scene hanging() {
  Scene scene;
  scene.cloths.resize(1);
  scene.cloths[0].grid = Grid{{0.3, 0.3}, 10, 10, Topology::diagonal, true};
  scene.cloths[0].anchors.push_back(held_at({Corner::low_high, Corner::high_high}));
  scene.cloths[0].fabric.damping = 6;
  return scene;
}

// One lies on the other, on the floor.
Scene lying() {
  Scene scene;
  for (int k = 0; k < 2; ++k) {
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{0.2, 0.2}, 8, 8, Topology::diagonal, false};
    cloth.transform.translate = {0, 0.004f + 0.004f * static_cast<float>(k), 0};
    cloth.fabric.damping = 6;
  }
  scene.colliders = {plane(0)};
  return scene;
}

void blow(Simulation& simulation, int frame) {
  if (frame == kBlown) must(simulation.set_gravity({6, -4, 1}));
}

struct Seen {
  int frames = 0;
  bool was_still = false;
  int without_contacts = 0, without_detections = 0;   // frames that recorded none of their passes
  int repeated = 0;                                   // that had detections where the ones before and after it had not looked for any
};

// By `advance`, until this frame is done, and what frames recorded.
void advance(Simulation& simulation, Seen& seen, int until) {
  for (int& frame = seen.frames; frame < until; ++frame) {
    blow(simulation, frame);
    const std::uint32_t before = simulation.counts().detections;
    must(simulation.advance(kFrame));
    const auto timings = simulation.timings();
    const auto has = [&](const char* pass) {
      return std::ranges::any_of(timings, [&](const PassTiming& timing) { return timing.name.starts_with(pass); });
    };
    const bool is_still = !has("detect_alone") && !has("detect_track");
    seen.without_contacts += is_still && !has("detect_arguments") && !has("contact_");
    seen.without_detections += is_still && has("detect_arguments") && has("contact_prepare") && has("contact_finalize");
    seen.repeated += seen.was_still && !is_still && simulation.counts().detections > before;
    EXPECT_TRUE(!is_still || simulation.counts().detections == before) << "frame " << frame;
    seen.was_still = is_still;
  }
}

// The same by frames that are not waited for.
void submit(Simulation& simulation, int from, int until) {
  for (int frame = from; frame < until; ++frame) {
    blow(simulation, frame);
    must(simulation.submit(kFrame));
  }
}

// Names of what their next frames would begin with.
std::vector<std::string> differing(const Simulation& a, const Simulation& b) {
  const Snapshot of_a = must(a.save()), of_b = must(b.save());
  std::vector<std::string> names;
  for (std::size_t k = 0; k < of_a.contents.size(); ++k)
    if (of_a.contents[k].bytes != of_b.contents.at(k).bytes) names.push_back(of_a.contents[k].name);
  return names;
}

SimulationOptions timed(bool idle_costs) {
  SimulationOptions options;
  options.timings = true;
  options.idle_costs = idle_costs;
  return options;
}

// Compares all that a frame leaves to the next when nothing has been due for long, when a frame has been repeated, and later.
TEST_F(Still, cloth_that_hangs_has_no_pass_of_contacts_and_leaves_what_is_left_with_all_of_them) {
  for (const bool idle_costs : {true, false}) {
    const auto simulation = must(Simulation::create(device(), hanging(), timed(idle_costs)));
    const auto other = must(Simulation::create(device(), hanging()));
    Seen seen;
    int frame = 0;
    for (const int until : {kBlown, kBlown + 1, kStillFrames}) {
      advance(*simulation, seen, until);
      submit(*other, std::exchange(frame, until), until);
      EXPECT_EQ(differing(*simulation, *other), std::vector<std::string>()) << "after " << until << " frames";
      EXPECT_EQ(simulation->counts().detections, other->counts().detections) << "after " << until << " frames";
    }
    EXPECT_GT(seen.without_contacts, 20);
    EXPECT_EQ(seen.repeated, 1) << "as gravity turns";
  }
}

TEST_F(Still, cloth_that_lies_on_cloth_is_not_searched_and_has_the_same_bits) {
  const auto other = must(Simulation::create(device(), lying()));
  submit(*other, 0, kStillFrames);
  EXPECT_GT(other->counts().contacts_most, 50u);
  for (const bool idle_costs : {true, false}) {
    const auto simulation = must(Simulation::create(device(), lying(), timed(idle_costs)));
    Seen seen;
    advance(*simulation, seen, kStillFrames);
    EXPECT_GT(seen.without_detections, 20);
    EXPECT_EQ(seen.repeated, 1);
    EXPECT_EQ(hash_of(*simulation), hash_of(*other));
    EXPECT_EQ(simulation->counts().detections, other->counts().detections);
  }
}

}  // namespace
}  // namespace weft
