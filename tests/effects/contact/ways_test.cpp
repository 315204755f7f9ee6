// Contacts in all three ways to run a frame: the same bits, no pair lost, and room that grows before it is needed, whoever waits for whom.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "compute/commands.h"
#include "tests/support/printing.h"
#include "tests/support/sheets.h"

namespace weft {
namespace {

using ContactWays = GpuTest;

constexpr int kWayFrames = 50;

// Nothing is said of contacts here: they are on.
//
// Dropped flat onto a ball and the floor: thousands of pairs within a few frames, where there were none.
Scene dropped() {
  Scene scene;
  scene.cloths.resize(1);
  scene.cloths[0].grid = Grid{{0.8, 0.8}, 40, 40, Topology::diagonal, false};
  scene.cloths[0].transform.translate = {0, 0.5f, 0};
  scene.colliders.resize(2);
  scene.colliders[0].shape = ColliderShape::sphere;
  scene.colliders[0].radius = 0.2;
  scene.colliders[0].centre = {0, 0.2f, 0};
  return scene;
}

// Five sheets that fall onto each other.
Scene piled() {
  Scene scene;
  for (int k = 0; k < 5; ++k) {
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{0.3, 0.3}, 12, 12, Topology::diagonal, false};
    cloth.transform.translate = {0.01f * static_cast<float>(k), 0.05f + 0.05f * static_cast<float>(k), 0};
    cloth.transform.degrees = 7.0 * k;
  }
  scene.colliders.resize(1);
  return scene;
}

std::uint64_t capacity_of(const Simulation& simulation) {
  for (const BufferUse& use : simulation.buffers())
    if (use.name == "candidates") return use.bytes / sizeof(gpu::uvec4);
  return 0;
}

struct Outcome {
  std::uint64_t hash, capacity;
  std::uint32_t lost = 0;   // as Advance has told
  Counts counts;
};

using Between = std::function<void(Simulation&, int frame)>;

Outcome outcome_of(const Simulation& simulation, std::uint32_t lost) {
  return {hash_of(simulation), capacity_of(simulation), lost, simulation.counts()};
}

Outcome advanced(const compute::Device& device, const Scene& scene, int frames = kWayFrames) {
  const auto simulation = must(Simulation::create(device, scene));
  std::uint32_t lost = 0;
  for (int frame = 0; frame < frames; ++frame) lost += must(simulation->advance(1.0 / 60)).pairs_lost;
  return outcome_of(*simulation, lost);
}

Outcome submitted(const compute::Device& device, const Scene& scene, const Between& between = {}, int frames = kWayFrames) {
  const auto simulation = must(Simulation::create(device, scene));
  std::uint32_t lost = 0;
  for (int frame = 0; frame < frames; ++frame) {
    if (between) between(*simulation, frame);
    lost += must(simulation->submit(1.0 / 60)).pairs_lost;
  }
  return outcome_of(*simulation, lost);
}

// A host that keeps up to `under_way` frames on the queue.
Outcome recorded(const compute::Device& device, const Scene& scene, std::uint64_t under_way, const Between& between = {},
                 std::uint64_t frames = kWayFrames) {
  const auto simulation = must(Simulation::create(device, scene));
  const auto pool = must(compute::CommandPool::create(device, "host"));
  const auto done = must(compute::create_timeline(device, "host"));
  std::uint32_t lost = 0;
  for (std::uint64_t frame = 1; frame <= frames; ++frame) {
    if (frame > under_way) must(compute::wait_for(device, done.get(), frame - under_way));
    if (between) between(*simulation, static_cast<int>(frame));
    const VkCommandBuffer commands = must(pool.allocate("host"));
    const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr, VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
                                         nullptr};
    EXPECT_EQ(device.vk().vkBeginCommandBuffer(commands, &begin), VK_SUCCESS);
    lost += must(simulation->record(commands, 1.0 / 60)).pairs_lost;
    EXPECT_EQ(device.vk().vkEndCommandBuffer(commands), VK_SUCCESS);
    const VkCommandBufferSubmitInfo work{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, commands, 0};
    const VkSemaphoreSubmitInfo signal{
        VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, done.get(), frame, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0};
    must(device.submit({VK_STRUCTURE_TYPE_SUBMIT_INFO_2, nullptr, 0, 0, nullptr, 1, &work, 1, &signal}));
  }
  must(compute::wait_for(device, done.get(), frames));
  device.wait_idle();   // the software driver (Mesa 22.3) looks at semaphores for a moment after they are signalled
  return outcome_of(*simulation, lost);
}

TEST_F(ContactWays, advance_submit_and_record_give_the_same_bits_and_lose_no_pair) {
  for (const Scene& scene : {dropped(), piled()}) {
    const Outcome waited = advanced(device(), scene);
    EXPECT_GT(waited.counts.contacts_most, 4000u) << "too few to tell anything";
    for (const Outcome& other : {submitted(device(), scene), recorded(device(), scene, 1), recorded(device(), scene, 3)}) {
      EXPECT_EQ(other.hash, waited.hash);
      EXPECT_EQ(other.lost + other.counts.contacts_overflowed, 0u);
      EXPECT_EQ(other.counts.contacts_room, waited.counts.contacts_room);
    }
  }
}

// Cells of 5 mm, 3 cm above each other.
Scene flat_sheets(std::size_t count) {
  Scene scene;
  for (std::size_t k = 0; k < count; ++k) {
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{0.2, 0.2}, 40, 40, Topology::diagonal, false};
    cloth.transform.translate = {0, 0.004f + 0.03f * static_cast<float>(k), 0};
  }
  scene.colliders = {plane(0)};
  return scene;
}

// From no candidate to a hundred thousand within a frame, more than one workgroup can do.
TEST_F(ContactWays, sheets_that_fall_flat_onto_each_other_lose_no_pair) {
  const Scene scene = flat_sheets(2);
  const Outcome waited = advanced(device(), scene, 9);
  EXPECT_GT(waited.counts.contacts_most, 80'000u);
  for (const Outcome& other : {submitted(device(), scene, {}, 9), recorded(device(), scene, 2, {}, 9)}) {
    EXPECT_EQ(other.hash, waited.hash);
    EXPECT_EQ(other.lost + other.counts.contacts_overflowed, 0u);
  }
}

// Gravity bends all trajectories alike: nothing of the sheet comes near anything else of it.
TEST_F(ContactWays, fine_cloth_that_falls_flat_has_no_candidates) {
  Scene scene = flat_sheets(1);
  scene.colliders.clear();
  EXPECT_EQ(advanced(device(), scene, 12).counts.contacts_most, 0u);
}

// A held sheet that is to stop where a free one lies on the floor, which leaves it no room, and then goes back, and rests.
Scene pressed_and_released() {
  Scene scene;
  scene.cloths.resize(2);
  scene.cloths[0].grid = Grid{{0.3, 0.3}, 10, 10, Topology::diagonal, false};
  scene.cloths[0].transform.translate = {0, 0.3f, 0};
  scene.cloths[1].grid = Grid{{0.2, 0.2}, 14, 14, Topology::diagonal, false};
  scene.cloths[1].transform.translate = {0, 0.12f, 0};
  scene.cloths[1].transform.axis = {1, 0, 0};
  scene.cloths[1].transform.degrees = 60;
  scene.colliders = {plane(0)};
  Anchor anchor;
  anchor.box = Anchor::Box{{-9, 0.29f, -9}, {9, 0.31f, 9}};
  const auto key = [](double time, float y) {
    Key key;
    key.time = time;
    key.translate = {0, y, 0};
    return key;
  };
  anchor.keys = {key(0.03, 0), key(0.11, -0.2995f), key(0.35, -0.2995f), key(0.42, -0.1f)};
  scene.cloths[0].anchors.push_back(anchor);
  scene.contacts.enabled = true;
  return scene;
}

// With `advance` the host knows that anchors rest, and records no pass for them; with `record` it knows nothing.
TEST_F(ContactWays, anchors_that_stop_and_set_off_again_leave_the_same_bits) {
  const Scene scene = pressed_and_released();
  SimulationOptions options;
  options.timings = true;
  const auto simulation = must(Simulation::create(device(), scene, options));
  int resting = 0;   // frames without a pass for anchors
  for (int frame = 0; frame < kWayFrames; ++frame) {
    EXPECT_EQ(must(simulation->advance(1.0 / 60)).pairs_lost, 0u);
    const auto timings = simulation->timings();
    resting += std::ranges::find(timings, "anchor+watch", &PassTiming::name) == timings.end();
  }
  EXPECT_GT(resting, 15) << "of the 24 at the end";
  EXPECT_LT(resting, 25) << "and none while they wait for room";
  EXPECT_GT(simulation->counts().tracking_error, 0.002f) << "none is late when they stop";
  options.idle_costs = false;   // the passes of a GPU
  const auto idling = must(Simulation::create(device(), scene, options));
  // Frames with detections by one workgroup; in which one dispatch searches, tests and prepares; whose substeps contacts' workgroup ends.
  int alone = 0, calm = 0, ended = 0;
  for (int frame = 0; frame < kWayFrames; ++frame) {
    must(idling->advance(1.0 / 60));
    const auto timings = idling->timings();
    alone += std::ranges::find(timings, "detect_alone", &PassTiming::name) != timings.end();
    calm += std::ranges::find(timings, "detect_prepare", &PassTiming::name) != timings.end();
    ended += std::ranges::find(timings, "contact_finalize", &PassTiming::name) == timings.end();
  }
  EXPECT_GT(calm, 0);
  EXPECT_GE(alone, calm);
  EXPECT_LT(alone, kWayFrames - 5);
  EXPECT_GT(ended, 0);
  EXPECT_EQ(hash_of(*idling), hash_of(*simulation));
  const auto halting = must(Simulation::create(device(), scene));   // frames in which no time passes tell nothing
  for (int frame = 0; frame < 3 * kWayFrames; ++frame) must(halting->advance(frame % 3 == 0 ? 1.0 / 60 : 0));
  EXPECT_EQ(hash_of(*halting), hash_of(*simulation));
  EXPECT_EQ(submitted(device(), scene).hash, hash_of(*simulation));
  EXPECT_EQ(recorded(device(), scene, 1).hash, hash_of(*simulation));
  EXPECT_EQ(recorded(device(), scene, 3).hash, hash_of(*simulation));
}

TEST_F(ContactWays, room_grows_before_it_is_needed_while_frames_are_under_way) {
  Scene scene = piled();
  const Outcome ample = advanced(device(), scene);
  scene.contacts.capacity = ample.counts.contacts_room / 4;
  const Outcome submitting = submitted(device(), scene), recording = recorded(device(), scene, 2);
  for (const Outcome& grown : {submitting, recording}) {
    EXPECT_GE(grown.capacity, ample.counts.contacts_room);
    EXPECT_EQ(grown.counts.contacts_overflowed, 0u);
    EXPECT_EQ(grown.hash, ample.hash);
  }
}

TEST_F(ContactWays, room_that_is_reserved_while_frames_are_under_way_changes_nothing_else) {
  Scene scene = piled();
  const Outcome ample = advanced(device(), scene);
  scene.contacts.capacity = ample.counts.contacts_room / 2;
  const Between reserve = [&](Simulation& simulation, int frame) {
    const std::uint32_t room = 4 * ample.counts.contacts_room + 1000 * static_cast<std::uint32_t>(frame);
    if (frame == 3 || frame == 20 || frame == 21) must(simulation.reserve_contacts(room));
    if (frame == 21) must(simulation.reserve_contacts(9 * ample.counts.contacts_room));   // twice before one frame
    if (frame == 22) must(simulation.reserve_contacts(1));                                 // there is more
  };
  for (const Outcome& other : {submitted(device(), scene, reserve), recorded(device(), scene, 3, reserve)}) {
    EXPECT_EQ(other.hash, ample.hash);
    EXPECT_EQ(other.counts.contacts_overflowed, 0u);
    EXPECT_EQ(other.capacity, 9 * ample.counts.contacts_room);
  }
}

TEST_F(ContactWays, reserving_more_than_there_can_be_is_refused_and_nothing_without_contacts) {
  Scene scene = piled();
  const auto simulation = must(Simulation::create(device(), scene));
  const std::uint64_t before = capacity_of(*simulation);
  const auto refused = simulation->reserve_contacts(kMostCandidates + 1);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("67108865 candidate pairs"), std::string::npos) << refused.error();
  EXPECT_EQ(capacity_of(*simulation), before);
  scene.contacts.enabled = false;
  must(must(Simulation::create(device(), scene))->reserve_contacts(1000));
}

// A held sheet driven at 40 m/s through one that is held by its corners: tens of thousands of contacts within a substep, where there were
// none a frame before. One workgroup did them until the software driver ended its loops, wherever it was in lists that are in any order.
TEST_F(ContactWays, a_violent_frame_has_the_same_bits_whoever_comes_first) {
  Scene scene;
  scene.gravity = {};
  scene.contacts.enabled = true;
  scene.contacts.capacity = 300'000;
  scene.cloths.resize(2);
  scene.cloths[0].grid = Grid{{1, 1}, 24, 24, Topology::diagonal, false};
  scene.cloths[0].tethers = false;
  scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::low_high, Corner::high_low, Corner::high_high}));
  scene.cloths[1].grid = Grid{{0.3f, 0.3f}, 10, 10, Topology::diagonal, true};
  scene.cloths[1].transform = {.translate = {0, 0.2f, 0}, .axis = {0, 1, 0}, .degrees = 20};
  Key start, end;
  end.time = 0.1;
  end.translate = {0, -4, 0};
  Anchor& all = scene.cloths[1].anchors.emplace_back();
  all.box = Anchor::Box{{-9, -9, -9}, {9, 9, 9}};
  all.keys = {start, end};
  std::vector<Outcome> outcomes;
  for (int k = 0; k < 3; ++k) {
    const auto simulation = must(Simulation::create(device(), scene));
    for (int frame = 0; frame < 8; ++frame) must(simulation->advance(1.0 / 60));
    outcomes.push_back(outcome_of(*simulation, 0));
    EXPECT_GT(outcomes[k].counts.contacts_most, 20'000u) << "too few to tell anything";
    EXPECT_EQ(outcomes[k].hash, outcomes[0].hash);
    EXPECT_EQ(outcomes[k].counts.contacts_overflowed, 0u);
  }
}

TEST_F(ContactWays, what_is_lost_is_told_once) {
  Scene scene = piled();
  scene.contacts.capacity = 16;
  const Outcome submitting = submitted(device(), scene), recording = recorded(device(), scene, 1);
  for (const Outcome& small : {submitting, recording}) {
    EXPECT_GT(small.lost, 0u);
    EXPECT_EQ(small.lost, small.counts.contacts_overflowed) << "nothing is lost in the last frames any more";
  }
  EXPECT_EQ(advanced(device(), scene).lost, 0u);
}

}  // namespace
}  // namespace weft
