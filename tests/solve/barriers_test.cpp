// Every barrier that a simulation needs is there, and none that it does not need: the commands of whole runs, heard on their way to
// Vulkan, are checked by hazards.h, and then once more without each of their barriers.
//
// The installed validation layer is silent about two dispatches that write one buffer, so its silence proves little.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "compute/commands.h"
#include "compute/shared_passes.h"
#include "engine/simulation.h"
#include "tests/support/every_method.h"
#include "tests/support/overheard_vulkan.h"

namespace weft {
namespace {

using hazards::Event;
using hazards::Stream;
using overheard::ear;

// How a host reads vertices: a single stage, and what it does there.
struct Reading {
  hazards::Stages stage = VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT;
  hazards::Accesses access = VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT;
};
using Readings = std::vector<Reading>;

// A host that draws every frame on Weft's queue, with no barrier of its own, and waits for nothing that it need not wait for.
class DrawingHost {
 public:
  DrawingHost(const compute::Device& device, Simulation& simulation, Readings readings)
      : device_(device), simulation_(simulation), readings_(std::move(readings)), pool_(must(compute::CommandPool::create(device, "host"))),
        done_(must(compute::create_timeline(device, "host done"))) {}
  ~DrawingHost() {
    wait();
    // The software driver (Mesa 22.3) looks at semaphores for a moment after they are signalled.
    device_.vk().vkQueueWaitIdle(device_.queue());
  }

  // All of its command buffers are new ones: two may be under way.
  template <class Record>
  void submit(const char* name, Record&& record, std::vector<VkSemaphoreSubmitInfo> waits = {}) {
    const VkCommandBuffer commands = must(pool_.allocate(name));
    const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr, VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
                                         nullptr};
    ASSERT_EQ(device_.vk().vkBeginCommandBuffer(commands, &begin), VK_SUCCESS);
    record(commands);
    ASSERT_EQ(device_.vk().vkEndCommandBuffer(commands), VK_SUCCESS);
    const VkCommandBufferSubmitInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, commands, 0};
    const VkSemaphoreSubmitInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, done_.get(), ++submitted_,
                                       VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0};
    must(device_.submit({VK_STRUCTURE_TYPE_SUBMIT_INFO_2, nullptr, 0, static_cast<std::uint32_t>(waits.size()), waits.data(), 1, &info, 1,
                         &signal}));
  }
  void draw(VkCommandBuffer commands) const {
    for (const FrameView& view : {simulation_.positions(), simulation_.normals()})
      for (const Reading& reading : readings_) ear.touches(commands, "draw", view.buffer, reading.stage, reading.access);
  }
  void draw() {
    submit("host draw", [&](VkCommandBuffer commands) { draw(commands); });
  }
  // A frame in its own command buffer, and the draw right behind it.
  void record(double seconds) {
    submit("host frame", [&](VkCommandBuffer commands) {
      must(simulation_.record(commands, seconds));
      draw(commands);
    });
  }
  // Weft submits the frame; the draw waits for it where it reads vertices.
  void let_submit(double seconds) {
    must(simulation_.submit(seconds));
    hazards::Stages stages = 0;
    for (const Reading& reading : readings_) stages |= reading.stage;
    submit("host draw", [&](VkCommandBuffer commands) { draw(commands); },
           {{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, simulation_.ready_semaphore(), simulation_.ready_value(), stages, 0}});
  }
  void let_advance(double seconds) {
    must(simulation_.advance(seconds));
    draw();
  }
  void wait() { must(compute::wait_for(device_, done_.get(), submitted_)); }

 private:
  const compute::Device& device_;
  Simulation& simulation_;
  Readings readings_;
  compute::CommandPool pool_;
  compute::OwnedSemaphore done_;
  std::uint64_t submitted_ = 0;
};

class Barriers : public GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    const compute::Device& own = GpuTest::device();
    ear.get_instance_proc_addr = own.vk().vkGetInstanceProcAddr;
    lent_ = must(compute::Device::borrow(
        {overheard::instance_function, own.instance(), own.physical(), own.handle(), own.queue(), own.queue_family()}));
  }

  // The stream of a simulation from its creation on.
  template <class Run>
  Stream heard(const Scene& scene, const SimulationOptions& options, bool computes, Run&& run, Readings readings = {{}}) {
    lent_->passes().clear();   // what was compiled for the last one has not been heard
    ear.begin();
    ear.computes = computes;
    {
      const auto simulation = must(Simulation::create(*lent_, scene, options));
      DrawingHost host(*lent_, *simulation, std::move(readings));
      run(*simulation, host);
    }
    return std::move(ear.stream);
  }
  // Frames of every kind, with substeps and without, two of them under way at once, and the host waiting for one alone.
  Stream filmed(const Scene& scene, const SimulationOptions& options = {}, Readings readings = {{}}) {
    return heard(scene, options, false, [&](Simulation&, DrawingHost& host) {
      const double frame = std::max(kFrame, 1 / scene.solver.rate);
      host.draw();
      for (const double seconds : {frame, frame, frame, 0.0}) host.let_submit(seconds);
      host.wait();
      host.let_submit(frame);
      host.wait();
      for (int k = 0; k < 2; ++k) host.let_advance(frame);
      for (const double seconds : {frame, frame, 0.0}) host.record(seconds);
      host.wait();
      host.record(frame);
    }, std::move(readings));
  }

 private:
  std::unique_ptr<compute::Device> lent_;
};

// The barriers of each frame, as events of the stream. A frame without substeps has two.
std::vector<std::vector<std::size_t>> barriers_of_frames(const Stream& stream) {
  std::vector<std::vector<std::size_t>> frames;
  const std::vector<Event>& events = stream.events;
  for (std::size_t begin = 0, end = 0; begin < events.size(); begin = end) {
    std::vector<std::size_t> barriers;
    for (; end < events.size() && events[end].commands == events[begin].commands; ++end)
      if (events[end].kind == Event::Kind::barrier) barriers.push_back(end);
    if (events[begin].commands == "weft frame" || events[begin].commands == "host frame") frames.push_back(std::move(barriers));
  }
  return frames;
}

// The barriers that frames can do without, "barrier 2 of weft frame". A frame's first barrier is for what may be under way before
// it, and its last for a host that waits: these two must be needed once by the stream, all others wherever they stand. Command buffers
// that are run once have barriers around commands that know nothing of what is before and after them: left out here.
std::set<std::string> needless_barriers(const Stream& stream) {
  std::set<std::string> needless, needed;
  const std::vector<std::size_t> redundant = hazards::redundant_barriers(stream);
  for (const std::vector<std::size_t>& barriers : barriers_of_frames(stream)) {
    for (std::size_t k = 0; k < barriers.size(); ++k) {
      const bool is_first = k == 0, is_last = k + 1 == barriers.size(), is_redundant = std::ranges::binary_search(redundant, barriers[k]);
      const std::string which = is_first ? "first barrier" : is_last ? "last barrier" : "barrier " + std::to_string(k);
      const std::string name = which + (barriers.size() > 2 ? "" : " without substeps") + " of " + stream.events[barriers[k]].commands;
      if (is_redundant) needless.insert(name);
      else if (is_first || is_last) needed.insert(name);
    }
  }
  EXPECT_EQ(needed.size(), 6u) << "both ends of frames with substeps, and the last of those without";
  for (const std::string& name : needed) needless.erase(name);
  return needless;
}

void expect_no_hazard(const Stream& stream) {
  for (const std::string& hazard : hazards::hazards_of(stream)) ADD_FAILURE() << hazard;
}

// A frame that takes no substep only copies the counters, and what has written them is behind the last frame's barriers already. Its
// first barrier stays: it is the one that says what a frame may come after.
const std::set<std::string> kOfFramesWithoutSubsteps = {"first barrier without substeps of weft frame",
                                                       "first barrier without substeps of host frame"};

TEST_F(Barriers, none_is_missing_and_none_is_needless_with_every_method) {
  for (const Subject& subject : subjects())
    for (const bool storage : {false, true}) {
      SCOPED_TRACE(std::string(subject.name) + (storage ? ", storage" : ", texels"));
      SimulationOptions options;
      options.gather_storage = storage;
      options.idle_costs = storage;   // the passes of the software driver, and those of others
      const Stream stream = filmed(subject.scene, options);
      expect_no_hazard(stream);
      EXPECT_EQ(needless_barriers(stream), kOfFramesWithoutSubsteps);
    }
}

TEST_F(Barriers, none_is_missing_and_none_is_needless_in_every_scene) {
  int scenes = 0;
  for (const char* folder : {WEFT_ASSETS "/scenes", WEFT_ASSETS "/scenes/hard"})
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() != ".json") continue;
      SCOPED_TRACE(entry.path().filename().string());
      const Stream stream = filmed(must(load_scene(entry.path())));
      expect_no_hazard(stream);
      EXPECT_EQ(needless_barriers(stream), kOfFramesWithoutSubsteps);
      ++scenes;
    }
  EXPECT_GE(scenes, 40);
}

constexpr hazards::Stages kOwn =
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;

// The stages of the signals behind Weft's own frames.
std::set<hazards::Stages> signals_of(const Stream& stream) {
  std::set<hazards::Stages> stages;
  for (std::size_t k = 1; k < stream.events.size(); ++k)
    if (stream.events[k].kind == Event::Kind::signal && stream.events[k - 1].commands == "weft frame")
      stages.insert(stream.events[k].stages);
  return stages;
}

// The stages and accesses at both ends of every frame, and what signals that Weft's own are done.
void expect_ends(const Stream& stream, const VkMemoryBarrier2& first, const VkMemoryBarrier2& results, hazards::Stages signalled) {
  const auto barrier = [&](std::size_t at) { return stream.events[at].barrier; };
  int with_results = 0;
  for (const std::vector<std::size_t>& barriers : barriers_of_frames(stream)) {
    EXPECT_EQ(barrier(barriers.front()).srcStageMask, first.srcStageMask);
    EXPECT_EQ(barrier(barriers.front()).srcAccessMask, first.srcAccessMask);
    EXPECT_EQ(barrier(barriers.front()).dstStageMask, kOwn);
    if (barriers.size() > 2) {
      ++with_results;
      EXPECT_EQ(barrier(barriers[barriers.size() - 2]).srcStageMask, results.srcStageMask);
      EXPECT_EQ(barrier(barriers[barriers.size() - 2]).dstStageMask, results.dstStageMask);
      EXPECT_EQ(barrier(barriers[barriers.size() - 2]).dstAccessMask, results.dstAccessMask);
    }
    for (std::size_t k = 1; k < barriers.size(); ++k) {
      EXPECT_EQ(barrier(barriers[k]).srcStageMask & ~kOwn, 0u) << "within a frame nobody waits for readers";
      const bool is_results = k + 2 == barriers.size();
      EXPECT_EQ(barrier(barriers[k]).dstStageMask & ~(kOwn | VK_PIPELINE_STAGE_2_HOST_BIT | (is_results ? results.dstStageMask : 0)), 0u);
    }
  }
  EXPECT_GT(with_results, 2);
  EXPECT_EQ(signals_of(stream), std::set{signalled});
}

constexpr hazards::Accesses kOwnWrites = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
constexpr hazards::Accesses kCopies = VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;

TEST_F(Barriers, a_host_that_says_nothing_of_its_readers_has_draws_dispatches_and_copies) {
  const hazards::Stages vertex = device().draws() ? VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT : 0;
  const hazards::Accesses drawn = device().draws() ? VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT : 0;
  VkMemoryBarrier2 first{}, results{};
  first.srcStageMask = kOwn | vertex | VK_PIPELINE_STAGE_2_HOST_BIT;
  first.srcAccessMask = kOwnWrites | VK_ACCESS_2_HOST_WRITE_BIT;
  results.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  results.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | vertex;
  results.dstAccessMask = kCopies | drawn | VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                          VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT;
  expect_ends(filmed(subjects().front().scene), first, results, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
}

// Frames wait for the readers that the host has named and show them their results, and nobody else: two are under way at once, with no
// barrier of the host's between.
TEST_F(Barriers, a_frame_has_to_do_with_the_readers_that_the_host_names_and_with_no_others) {
  const Reading draws, skins{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT},
      pulls{VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT},
      copies{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
  for (const Readings& readings : {Readings{draws}, Readings{skins}, Readings{pulls}, Readings{copies}, Readings{draws, skins, copies}}) {
    SimulationOptions options;
    options.readers.emplace();
    for (const Reading& reading : readings) {
      options.readers->stages |= reading.stage;
      options.readers->accesses |= reading.access;
    }
    SCOPED_TRACE(options.readers->stages);
    VkMemoryBarrier2 first{}, results{};
    first.srcStageMask = kOwn | options.readers->stages;
    first.srcAccessMask = kOwnWrites;
    results.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    results.dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | options.readers->stages;
    results.dstAccessMask = kCopies | options.readers->accesses;
    for (const std::size_t subject : {std::size_t{0}, subjects().size() - 1}) {
      const Stream stream = filmed(subjects()[subject].scene, options, readings);
      expect_no_hazard(stream);
      // Readers in Weft's own stages would be waited for within the frame, too.
      if (options.readers->stages & ~hazards::single(kOwn)) {
        EXPECT_EQ(needless_barriers(stream), kOfFramesWithoutSubsteps);
      }
      expect_ends(stream, first, results, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT);
      // Whoever is not named finds neither the results nor a frame that waits.
      for (const Reading& other : {draws, skins, pulls, copies}) {
        if (options.readers->stages & other.stage || other.stage == copies.stage) continue;   // Weft's own report copies
        const std::vector<std::string> hazards = hazards::hazards_of(filmed(subjects()[subject].scene, options, {other}));
        const auto tells = [&](const char* kind) {
          return std::ranges::any_of(hazards, [&](const std::string& hazard) { return hazard.starts_with(kind); });
        };
        EXPECT_TRUE(tells("read after write")) << other.stage;
        EXPECT_EQ(tells("write after read"), (other.stage & hazards::with_earlier(first.srcStageMask)) == 0) << other.stage;
      }
    }
  }
}

TEST_F(Barriers, readers_behind_a_submitted_frame_on_its_queue_need_no_semaphore) {
  for (const bool named : {false, true}) {
    SimulationOptions options;
    if (named) options.readers = {Reading().stage, Reading().access};
    expect_no_hazard(heard(subjects().front().scene, options, false, [&](Simulation& simulation, DrawingHost& host) {
      for (int k = 0; k < 3; ++k) {
        must(simulation.submit(kFrame));
        host.draw();
      }
    }));
  }
}

// Timestamps wait for all commands: they can be read when the frame is told to be done.
TEST_F(Barriers, a_frame_with_timestamps_is_done_when_all_commands_are) {
  if (device().timestamp_period_ns() == 0) GTEST_SKIP() << "no timestamps";
  SimulationOptions options;
  options.timings = true;
  options.readers = {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
  const Stream stream = heard(subjects().front().scene, options, false, [](Simulation&, DrawingHost& host) { host.let_submit(kFrame); });
  EXPECT_EQ(signals_of(stream), std::set<hazards::Stages>{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT});
}

// Candidates overflow: frames are repeated with a larger capacity, which is made while others are under way.
TEST_F(Barriers, none_is_missing_where_frames_are_repeated_and_states_are_written) {
  const Scene scene = subjects().back().scene;
  ASSERT_GT(scene.contacts.capacity, 0u);
  for (const bool at_once : {false, true}) {
    std::uint32_t found = 0;
    const Stream stream = heard(scene, {}, true, [&](Simulation& simulation, DrawingHost& host) {
      host.draw();
      for (int k = 0; k < 4; ++k) at_once ? host.let_advance(kFrame) : host.let_submit(kFrame);
      const Snapshot snapshot = must(simulation.save());
      host.record(kFrame);
      host.record(kFrame);
      host.wait();
      auto positions = must(simulation.read_positions());
      must(simulation.write_positions(positions));
      host.draw();
      must(simulation.write_velocities(must(simulation.read_velocities())));
      host.let_submit(kFrame);
      must(simulation.restore(snapshot));
      host.draw();
      host.let_advance(kFrame);
      must(simulation.read_vertex_normals());
      found = simulation.counts().contacts_most;
    });
    EXPECT_GT(found, scene.contacts.capacity) << "no candidate has overflowed";
    const bool repeated = std::ranges::any_of(stream.events, [](const Event& event) { return event.commands == "weft repeat"; });
    EXPECT_EQ(repeated, at_once) << "after a submit there is more room";
    expect_no_hazard(stream);
  }
}

// What a frame reports is read when it is done, by the frame that takes its place: neither how fast the device is nor whether the host
// waits and asks decides when the capacity grows.
TEST_F(Barriers, a_host_that_waits_and_asks_gets_more_capacity_no_sooner_than_one_that_does_not) {
  Scene scene = subjects().back().scene;
  scene.solver.substeps = 4;
  int grown_at[2] = {-1, -1}, told_at = -1;
  for (const bool patient : {false, true})
    heard(scene, {}, true, [&](Simulation& simulation, DrawingHost& host) {
      const auto candidates = [&] {
        for (const BufferUse& use : simulation.buffers())
          if (use.name == "candidates") return use.bytes;
        return std::uint64_t{0};
      };
      const std::uint64_t first = candidates();
      for (int frame = 0; frame < 8 && grown_at[patient] < 0; ++frame) {
        host.let_submit(kFrame);
        if (candidates() > first) grown_at[patient] = frame;
        if (!patient) continue;
        host.wait();
        if (told_at < 0 && 3 * simulation.counts().contacts_room > scene.contacts.capacity) told_at = frame;
      }
    });
  EXPECT_GE(told_at, 0);
  EXPECT_EQ(grown_at[true], told_at + 2);
  EXPECT_EQ(grown_at[false], told_at + 2);
}

// Passes one by one, until there is no memory for a submit: the next frame begins with putting this one back.
TEST_F(Barriers, none_is_missing_where_a_torn_frame_is_put_back) {
  SimulationOptions options;
  options.timings = options.timings_on_cpu = true;
  for (Subject& subject : subjects())
    for (const double seconds : {kFrame, 0.0}) {
      subject.scene.solver.substeps = 2;
      const Stream stream = heard(subject.scene, options, false, [&](Simulation& simulation, DrawingHost& host) {
        host.let_advance(kFrame);
        ear.submits_left = 5;
        EXPECT_FALSE(simulation.advance(kFrame));
        ear.submits_left = -1;
        host.record(seconds);
        host.record(kFrame);
      });
      SCOPED_TRACE(subject.name);
      expect_no_hazard(stream);
      const auto first = std::ranges::find_if(stream.events, [](const Event& event) { return event.commands == "host frame"; });
      ASSERT_GT(stream.events.end() - first, 2);
      EXPECT_EQ(first[1].name, "copy") << "the frame is not put back";
    }
}

}  // namespace
}  // namespace weft
