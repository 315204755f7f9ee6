// The public API: what it promises about time, refusals, plans and the three ways to run a frame. Physics is in
// tests/solve/physics_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>

#include "compute/commands.h"
#include "tests/support/sheets.h"
#include "tests/support/ways.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using SimulationApi = GpuTest;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

// Every effect at once: anchors with keys, bending, tethers, a moving sphere and a floor.
Scene everything() {
  Scene scene = sheet(16);
  scene.cloths[0].fabric.damping = 0.1;
  Anchor moving = held_at({Corner::low_low, Corner::high_low});
  moving.keys = {{0, {0, 0, 0}, {0, 1, 0}, 0}, {0.5, {0.1f, 0, 0.2f}, {0, 1, 0}, 40}};
  scene.cloths[0].anchors.push_back(moving);
  scene.colliders = {plane(-0.8f), sphere({0, -0.4f, 0}, 0.3)};
  scene.colliders[1].keys = {{0, {0, 0, 0}, {0, 1, 0}, 0}, {0.5, {0.3f, 0, 0}, {0, 1, 0}, 90}};
  return scene;
}

TEST_F(SimulationApi, two_fresh_simulations_agree_to_the_bit) {
  for (const std::uint32_t iterations : {1u, 3u}) {
    Scene scene = everything();
    scene.solver.iterations = iterations;
    std::uint64_t hashes[2];
    for (std::uint64_t& hash : hashes) {
      const auto simulation = must(Simulation::create(device(), scene));
      run(*simulation, 0.5);
      hash = hash_of(*simulation);
      EXPECT_EQ(simulation->counts().non_finite, 0u);
      EXPECT_EQ(simulation->counts().coincident, 0u);
    }
    EXPECT_EQ(hashes[0], hashes[1]);
  }
}

TEST_F(SimulationApi, timing_passes_on_either_clock_changes_no_bit_and_names_every_dispatch) {
  std::uint64_t hashes[3];
  for (const int clock : {0, 1, 2}) {   // none, the GPU's, the CPU's
    SimulationOptions options;
    options.timings = clock > 0;
    options.timings_on_cpu = clock == 2;
    const auto simulation = must(Simulation::create(device(), everything(), options));
    run(*simulation, 0.25);
    hashes[clock] = hash_of(*simulation);
    EXPECT_EQ(simulation->timed_on_cpu(), clock == 2);
    const auto timings = simulation->timings();
    const auto passes = clock == 0 ? std::vector<PassUse>() : simulation->passes();
    ASSERT_EQ(timings.size(), passes.size());
    for (std::size_t k = 0; k < passes.size(); ++k) {
      EXPECT_EQ(timings[k].name, passes[k].name);
      EXPECT_EQ(timings[k].dispatches, passes[k].dispatches_per_frame) << passes[k].name;
      EXPECT_GE(timings[k].milliseconds, 0);
    }
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST_F(SimulationApi, both_ways_to_gather_give_the_same_frames) {
  for (const std::uint32_t iterations : {1u, 2u}) {
    Scene scene = everything();
    scene.solver.iterations = iterations;
    std::uint64_t hashes[2];
    for (const bool storage : {false, true}) {
      SimulationOptions options;
      options.gather_storage = storage;
      const auto simulation = must(Simulation::create(device(), scene, options));
      run(*simulation, 0.25);
      hashes[storage] = hash_of(*simulation);
    }
    EXPECT_EQ(hashes[0], hashes[1]);
  }
}

TEST_F(SimulationApi, the_width_of_workgroups_changes_nothing) {
  std::set<std::uint64_t> hashes;
  for (const std::uint32_t width : {0u, 32u, 256u}) {
    SimulationOptions options;
    options.workgroup = width;
    const auto simulation = must(Simulation::create(device(), everything(), options));
    run(*simulation, 0.25);
    hashes.insert(hash_of(*simulation));
  }
  EXPECT_EQ(hashes.size(), 1u);
}

// Substeps are fixed, so the frame rate of the host only says how many of them a frame has.
TEST_F(SimulationApi, frame_rates_of_30_60_and_120_give_the_same_state_to_the_bit) {
  Scene scene = sheet(16);
  scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_low}));
  scene.colliders = {sphere({0, -0.4f, 0}, 0.3)};
  std::set<std::uint64_t> hashes;
  for (const double rate : {30.0, 60.0, 120.0}) {
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 1, 1 / rate);
    EXPECT_NEAR(simulation->time(), 1, 1e-9);
    hashes.insert(hash_of(*simulation));
  }
  EXPECT_EQ(hashes.size(), 1u);
}

TEST_F(SimulationApi, time_that_is_left_over_waits_for_the_next_frame) {
  Scene scene = sheet(4);
  scene.solver.substeps = 10;   // of 1/600 s
  const auto simulation = must(Simulation::create(device(), scene));
  const Advance first = must(simulation->advance(0.6 / 600)), second = must(simulation->advance(0.6 / 600));
  EXPECT_EQ(first.substeps, 0u);
  EXPECT_EQ(second.substeps, 1u);
  EXPECT_NEAR(simulation->time(), 1.0 / 600, 1e-12);
  EXPECT_EQ(must(simulation->advance(0)).substeps, 0u);
}

TEST_F(SimulationApi, a_hitch_is_clamped_and_reported) {
  Scene scene = sheet(4);
  scene.solver.longest_advance = 0.1;
  const auto simulation = must(Simulation::create(device(), scene));
  const Advance advance = must(simulation->advance(0.75));
  EXPECT_NEAR(advance.clamped, 0.65, 1e-12);
  EXPECT_NEAR(advance.simulated, 0.1, 1e-9);
  EXPECT_NEAR(simulation->time(), 0.1, 1e-9);
  EXPECT_EQ(must(simulation->advance(kFrame)).clamped, 0);
}

// F15: whatever the frames of the host are like, each second of theirs was simulated, is left over for the next, or was reported.
TEST_F(SimulationApi, no_second_is_lost_without_a_word_however_uneven_the_frames) {
  Scene scene = sheet(2);
  scene.solver.longest_advance = 0.05;
  const auto simulation = must(Simulation::create(device(), scene));
  const double h = simulation->fabric().h, frames[] = {0.001, 0.5, 0, 0.0166, 0.05, 3, 0.0007, 0.0499, 1e-9, 0.12};
  double given = 0, simulated = 0, clamped = 0;
  std::uint32_t substeps = 0;
  for (int k = 0; k < 60; ++k) {
    const double seconds = frames[k % 10];
    Advance done;
    if (k % 3 == 0) done = must(simulation->advance(seconds));
    else if (k % 3 == 1) done = must(simulation->submit(seconds));
    else must(compute::run_once(device(), "the host's", [&](VkCommandBuffer c) { done = must(simulation->record(c, seconds)); }));
    EXPECT_NEAR(done.clamped, std::max(0.0, seconds - 0.05), 1e-12);
    EXPECT_NEAR(done.simulated, done.substeps * h, 1e-12);
    given += seconds, simulated += done.simulated, clamped += done.clamped, substeps += done.substeps;
    const double left_over = given - simulated - clamped;
    EXPECT_GE(left_over, -1e-6 * h);   // plan_frame takes a millionth of a substep for rounding
    EXPECT_LT(left_over, h);
  }
  EXPECT_NEAR(simulation->time(), substeps * h, 1e-9);
}

template <class T>
void expect_refused(Result<T> result, const std::string& word) {
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().find(word), std::string::npos) << result.error();
}

TEST_F(SimulationApi, seconds_that_are_not_a_length_of_time_are_refused_and_change_nothing) {
  const auto simulation = must(Simulation::create(device(), everything()));
  run(*simulation, 0.05);
  const std::uint64_t before = hash_of(*simulation);
  const auto never_used = reinterpret_cast<VkCommandBuffer>(std::uintptr_t{16});
  for (const double seconds : {kNothing, -0.1, std::numeric_limits<double>::infinity()}) {
    expect_refused(simulation->advance(seconds), "finite");
    expect_refused(simulation->submit(seconds), "finite");
    expect_refused(simulation->record(never_used, seconds), "finite");
  }
  EXPECT_EQ(hash_of(*simulation), before);
  EXPECT_NEAR(simulation->time(), 0.05, 1e-9);
}

// Two keys in a row have different axes: a scene then takes the rotation between them from their quaternions, as it does for a host.
TEST_F(SimulationApi, a_host_that_does_what_a_scenes_keys_do_gets_the_same_bits) {
  Scene keyed = everything(), hosted = everything();
  keyed.colliders = {plane(-0.8f), sphere({0, -0.4f, 0}, 0.3), {}};
  keyed.colliders[2].shape = ColliderShape::box;
  keyed.colliders[2].size = {0.5f, 0.2f, 0.4f};
  for (Collider& collider : keyed.colliders)
    for (int k = 0; k <= 60; ++k) {
      const float s = std::sin(0.1f * float(k)), c = std::cos(0.1f * float(k)), size = std::sqrt(1 + c * c);
      collider.keys.push_back({k * kFrame, {0, 0.2f * s, 0}, {s / size, c / size, c / size}, 3.7 * k});
    }
  hosted.colliders = keyed.colliders;
  for (const Way way : kWays) {
    const auto a = must(Simulation::create(device(), keyed)), b = must(Simulation::create(device(), hosted));
    for (int frame = 0; frame < 30; ++frame) {
      run_frame(device(), *a, way);
      const std::vector<ColliderPose> poses(a->colliders().begin(), a->colliders().end());
      must(b->move_colliders(0, poses));
      run_frame(device(), *b, way);
      for (std::size_t k = 0; k < poses.size(); ++k) ASSERT_EQ(b->colliders()[k], poses[k]) << "frame " << frame << ", collider " << k;
    }
  }
}

TEST_F(SimulationApi, bad_input_is_refused_with_a_sentence_that_names_it) {
  const auto simulation = must(Simulation::create(device(), everything()));
  const Vec3 good{0, 1, 0}, bad{0, kNotANumber, 0};
  const Vec3 targets[] = {good, good, good};
  expect_refused(simulation->move_anchors(0, targets), "beyond the simulation's 2");
  expect_refused(simulation->move_anchors(3, {}), "beyond");
  expect_refused(simulation->move_anchors(0xffffffffu, targets), "beyond");
  const Vec3 second_bad[] = {good, bad};
  expect_refused(simulation->move_anchors(0, second_bad), "anchor 1");
  expect_refused(simulation->move_collider(2, {good, good}), "2");
  const ColliderPose poses[] = {{good, good}, {good, bad}};
  expect_refused(simulation->move_colliders(0, poses), "collider 1");
  expect_refused(simulation->move_colliders(1, poses), "beyond the simulation's 2");
  expect_refused(simulation->move_collider(0, {bad, good}), "collider 0");
  expect_refused(simulation->move_collider(0, {good, bad}), "collider 0");
  expect_refused(simulation->move_collider(0, {good, {0, 0, 0}}), "normal");
  expect_refused(simulation->move_collider(1, {good, good, {0, 0, 0, 0}}), "rotation of collider 1");
  expect_refused(simulation->move_collider(1, {good, good, {0, 0, kNotANumber, 1}}), "not finite");
  expect_refused(simulation->set_gravity(bad), "gravity");
  const std::vector<gpu::vec4> too_few(3);
  expect_refused(simulation->write_positions(too_few), "3");
  expect_refused(simulation->write_velocities(too_few), "3");
  must(simulation->advance(kFrame));
  EXPECT_EQ(simulation->counts().non_finite, 0u);
}

TEST_F(SimulationApi, what_is_written_can_be_read_back_and_drawn_at_once) {
  const auto simulation = must(Simulation::create(device(), everything()));
  run(*simulation, 0.05);
  auto pose = must(simulation->read_positions());
  for (gpu::vec4& p : pose) p = {2 * p.x, p.y + 1, p.z, -7};   // w is the solver's
  must(simulation->write_positions(pose));
  const auto read = must(simulation->read_positions());
  const auto vertices = must(simulation->read_vertex_positions());
  for (std::size_t i = 0; i < pose.size(); ++i) {
    EXPECT_EQ(std::memcmp(&read[i], &pose[i], 12), 0);
    EXPECT_EQ(read[i].w, simulation->fabric().positions[i].w);
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const gpu::vec4& p = pose[simulation->fabric().surface_rows[v].x];
    EXPECT_EQ(vertices[v], (Vec3{p.x, p.y, p.z}));
  }
}

// Which passes and buffers a scene has, as one text.
struct Plan {
  std::set<std::string> passes, buffers;
};
Plan plan_of(const compute::Device& device, const Scene& scene) {
  const auto simulation = must(Simulation::create(device, scene));
  Plan plan;
  for (const PassUse& pass : simulation->passes()) plan.passes.insert(pass.name);
  for (const BufferUse& buffer : simulation->buffers()) {
    EXPECT_GT(buffer.bytes, 0u);
    plan.buffers.insert(buffer.name);
  }
  return plan;
}
bool mentions(const std::set<std::string>& names, const std::string& word) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) { return name.find(word) != std::string::npos; });
}

TEST_F(SimulationApi, an_effect_that_a_scene_does_not_call_for_has_no_pass_and_no_buffer) {
  Scene all = everything();
  all.solver.iterations = 2;
  const Plan full = plan_of(device(), all);
  for (const char* word : {"bend", "tether", "collide", "anchor"}) EXPECT_TRUE(mentions(full.passes, word)) << word;
  for (const char* word : {"bend", "tether", "collider", "anchor", "lambda"}) EXPECT_TRUE(mentions(full.buffers, word)) << word;

  Scene scene = everything();
  scene.cloths[0].bending = false;
  Plan plan = plan_of(device(), scene);
  EXPECT_FALSE(mentions(plan.passes, "bend") || mentions(plan.buffers, "bend"));

  scene = everything();
  scene.cloths[0].tethers = false;
  plan = plan_of(device(), scene);
  EXPECT_FALSE(mentions(plan.passes, "tether") || mentions(plan.buffers, "tether"));

  scene = everything();
  scene.colliders.clear();
  plan = plan_of(device(), scene);
  EXPECT_FALSE(mentions(plan.passes, "collide") || mentions(plan.buffers, "collider"));

  scene = everything();
  scene.cloths[0].anchors.clear();
  plan = plan_of(device(), scene);
  EXPECT_FALSE(mentions(plan.passes, "anchor") || mentions(plan.buffers, "anchor"));
  EXPECT_FALSE(mentions(plan.passes, "tether") || mentions(plan.buffers, "tether"));   // nothing to hang on to (F11)

  plan = plan_of(device(), everything());   // one iteration a substep
  EXPECT_FALSE(mentions(plan.buffers, "lambda") || mentions(plan.buffers, "impulses") || mentions(plan.buffers, "bends"));
}

TEST_F(SimulationApi, timings_name_every_pass_of_the_plan) {
  SimulationOptions options;
  options.timings = true;
  const auto simulation = must(Simulation::create(device(), everything(), options));
  must(simulation->advance(kFrame));
  std::set<std::string> timed, planned;
  for (const PassTiming& pass : simulation->timings()) {
    timed.insert(pass.name);
    EXPECT_GE(pass.milliseconds, 0);
  }
  for (const PassUse& pass : simulation->passes()) planned.insert(pass.name);
  EXPECT_EQ(timed, planned);
}

TEST_F(SimulationApi, frames_that_are_submitted_ahead_equal_frames_that_are_awaited) {
  const auto awaited = must(Simulation::create(device(), everything())), ahead = must(Simulation::create(device(), everything()));
  run(*awaited, 12 * kFrame);
  for (int k = 0; k < 12; ++k) {
    must(ahead->submit(kFrame));
    EXPECT_EQ(ahead->ready_value(), static_cast<std::uint64_t>(k + 1));
  }
  must(compute::wait_for(device(), ahead->ready_semaphore(), ahead->ready_value()));
  EXPECT_EQ(hash_of(*ahead), hash_of(*awaited));
}

TEST_F(SimulationApi, a_submitted_frame_waits_for_the_hosts_semaphore) {
  const auto simulation = must(Simulation::create(device(), everything()));
  const auto gate = must(compute::create_timeline(device(), "gate"));
  for (const std::uint64_t value : {1u, 2u}) {
    const VkSemaphoreSubmitInfo wait{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, gate.get(), value,
                                     VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0};
    must(simulation->submit(kFrame, std::span(&wait, 1)));
  }
  std::uint64_t done = 0;
  device().vk().vkGetSemaphoreCounterValue(device().handle(), simulation->ready_semaphore(), &done);
  EXPECT_EQ(done, 0u);
  const VkSemaphoreSignalInfo open{VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO, nullptr, gate.get(), 2};
  ASSERT_EQ(device().vk().vkSignalSemaphore(device().handle(), &open), VK_SUCCESS);
  must(simulation->submit(kFrame));
  const auto awaited = must(Simulation::create(device(), everything()));
  run(*awaited, 3 * kFrame);
  EXPECT_EQ(hash_of(*simulation), hash_of(*awaited));
}

TEST_F(SimulationApi, frames_in_the_hosts_command_buffer_equal_frames_that_are_awaited) {
  const auto awaited = must(Simulation::create(device(), everything())), recorded = must(Simulation::create(device(), everything()));
  run(*awaited, 6 * kFrame);
  for (int k = 0; k < 3; ++k)
    must(compute::run_once(device(), "the host's", [&](VkCommandBuffer commands) {
      must(recorded->record(commands, kFrame));   // two frames in one command buffer
      must(recorded->record(commands, kFrame));
    }));
  EXPECT_EQ(hash_of(*recorded), hash_of(*awaited));
  EXPECT_EQ(must(recorded->read_vertex_normals()), must(awaited->read_vertex_normals()));
  EXPECT_NEAR(recorded->time(), awaited->time(), 1e-12);
}

TEST_F(SimulationApi, views_name_a_vertex_per_render_vertex) {
  Scene scene = everything();
  scene.cloths.push_back(sheet(5).cloths[0]);
  const auto simulation = must(Simulation::create(device(), scene));
  EXPECT_EQ(simulation->positions().count, 17u * 17 + 6 * 6);
  EXPECT_EQ(simulation->normals().count, simulation->positions().count);
  EXPECT_NE(simulation->positions().buffer, simulation->normals().buffer);
  EXPECT_EQ(simulation->positions().stride, 16u);
}

TEST_F(SimulationApi, a_capacity_that_the_device_has_no_room_for_is_refused_by_its_key_and_value) {
  Scene scene = sheet(4);
  scene.contacts.enabled = true;
  scene.contacts.capacity = kMostCandidates;
  const auto made = Simulation::create(device(), scene);
  if (made) GTEST_SKIP() << "this device has room for that many";
  EXPECT_TRUE(made.error().starts_with("contacts.capacity: 67108864 candidate pairs")) << made.error();
}

TEST_F(SimulationApi, a_scene_that_cannot_be_cooked_is_refused) {
  Scene scene = without_contacts();
  expect_refused(Simulation::create(device(), scene), "cloths: is empty: at least 1 is needed");
  scene = sheet(4);
  Anchor beyond;
  beyond.vertices = {25};
  scene.cloths[0].anchors.push_back(beyond);
  expect_refused(Simulation::create(device(), scene), "25");
  scene = sheet(4);
  scene.cloths[0].grid.reset();
  scene.cloths[0].mesh = "no such file.glb";
  expect_refused(Simulation::create(device(), scene), "no such file.glb");
}

}  // namespace
}  // namespace weft
