// Recording: the rule for barriers as a truth table, and real passes with the barriers, times and caches they get.
#include "compute/recorder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "arguments.h"
#include "compute/buffer.h"
#include "compute/commands.h"
#include "compute/descriptors.h"
#include "compute/pipeline.h"
#include "scale.h"
#include "tests/support/on_device.h"
#include "tests/support/overheard_vulkan.h"

namespace weft::compute {
namespace {

// Two buffers, far enough apart that no machine word has a bit for both.
const IndexSet kNone, kA{0}, kB{200}, kBoth{0, 200};

TEST(Hazards, a_fresh_tracker_needs_no_barrier) {
  const HazardTracker tracker;
  EXPECT_FALSE(tracker.needs_barrier({kBoth, kBoth, kBoth}));
}

TEST(Hazards, only_two_reads_go_together) {
  for (const bool was_read : {false, true}) {
    for (const bool was_written : {false, true}) {
      HazardTracker tracker;
      tracker.note({was_read ? kB : kNone, was_written ? kB : kNone, kNone});
      EXPECT_FALSE(tracker.needs_barrier({}));
      EXPECT_EQ(tracker.needs_barrier({kB, kNone, kNone}), was_written);
      EXPECT_EQ(tracker.needs_barrier({kNone, kB, kNone}), was_read || was_written);
      EXPECT_EQ(tracker.needs_barrier({kB, kB, kNone}), was_read || was_written);
      EXPECT_FALSE(tracker.needs_barrier({kA, kA, kNone})) << "another buffer";
    }
  }
}

TEST(Hazards, a_barrier_settles_everything_before_it) {
  HazardTracker tracker;
  tracker.note({kA, kB, kNone});
  tracker.barrier();
  EXPECT_FALSE(tracker.needs_barrier({kBoth, kBoth, kNone}));
  tracker.note({kB, kNone, kNone});
  EXPECT_TRUE(tracker.needs_barrier({kNone, kB, kNone}));
}

TEST(Hazards, a_barrier_between_shaders_does_not_reach_the_reading_of_arguments) {
  HazardTracker tracker;
  tracker.note({kNone, kA, kNone});
  tracker.barrier();
  EXPECT_FALSE(tracker.needs_barrier({kA, kNone, kNone}));
  EXPECT_TRUE(tracker.needs_barrier({kNone, kNone, kA}));
  tracker.barrier(true);
  EXPECT_FALSE(tracker.needs_barrier({kNone, kNone, kA}));
}

TEST(Hazards, arguments_are_not_overwritten_while_they_are_read) {
  HazardTracker tracker;
  tracker.note({kNone, kNone, kA});
  EXPECT_TRUE(tracker.waits_for_indirect());
  EXPECT_FALSE(tracker.needs_barrier({kA, kNone, kA}));
  EXPECT_TRUE(tracker.needs_barrier({kNone, kA, kNone}));
}

TEST(IndexSet, holds_numbers_of_any_size) {
  IndexSet set{3, 64};
  set.insert(1000);
  EXPECT_TRUE(set.contains(3) && set.contains(64) && set.contains(1000));
  EXPECT_FALSE(set.contains(4) || set.contains(100000));
  EXPECT_TRUE(set.intersects(IndexSet{1000}));
  EXPECT_FALSE(set.intersects(IndexSet{1001, 5}));
  set.erase(1000);
  EXPECT_EQ(set, (IndexSet{64, 3})) << "however long it once was";
  set.clear();
  EXPECT_TRUE(set.empty());
}

/// Two kernels over VALUES and ARGUMENTS, and what it takes to run them.
struct Bench {
  Arena arena;
  DescriptorLayout layout;
  OwnedPipelineLayout pipeline_layout;
  DescriptorSet set;
  PipelineCache cache;
  ComputePipeline scale, arguments;

  struct Push {
    uint32_t count, term;
  };
  static constexpr uint32_t kCount = 1000;
  inline static const IndexSet kValues{0}, kArguments{1};

  static Result<Bench> create(const Device& device, const std::filesystem::path& cache_path = {}) {
    Bench bench;
    const BufferRequest requests[] = {{"values", kCount * 4, kStorage},
                                      {"arguments", 12, kStorage | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT}};
    Result<Arena> arena = Arena::create(device, Memory::device, "bench", requests);
    if (!arena) return arena.take_error();
    bench.arena = std::move(*arena);
    const DescriptorBinding bindings[] = {{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                                          {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}};
    Result<DescriptorLayout> layout = DescriptorLayout::create(device, "bench", bindings);
    if (!layout) return layout.take_error();
    bench.layout = std::move(*layout);
    const VkDescriptorSetLayout handle = bench.layout.handle();
    Result<OwnedPipelineLayout> pipeline_layout = create_pipeline_layout(device, "bench", {&handle, 1}, sizeof(Push));
    if (!pipeline_layout) return pipeline_layout.take_error();
    bench.pipeline_layout = std::move(*pipeline_layout);
    const BoundBuffer bound[] = {{0, &bench.arena[0]}, {1, &bench.arena[1]}};
    Result<DescriptorSet> set = DescriptorSet::create(device, "bench", bench.layout, bound);
    if (!set) return set.take_error();
    bench.set = std::move(*set);
    Result<PipelineCache> cache = PipelineCache::create(device, cache_path);
    if (!cache) return cache.take_error();
    bench.cache = std::move(*cache);
    const SpecializationConstant constants[] = {{0, 64}, {1, 3}};
    Result<ComputePipeline> scale =
        ComputePipeline::create(device, &bench.cache, "scale", ::scale, constants, bench.pipeline_layout.get());
    if (!scale) return scale.take_error();
    bench.scale = std::move(*scale);
    Result<ComputePipeline> arguments =
        ComputePipeline::create(device, &bench.cache, "arguments", ::arguments, {}, bench.pipeline_layout.get());
    if (!arguments) return arguments.take_error();
    bench.arguments = std::move(*arguments);
    return bench;
  }

  void bind(Recorder& recorder, const ComputePipeline& pipeline, uint32_t term) const {
    const VkDescriptorSet sets[] = {set.handle()};
    const Push push{kCount, term};
    recorder.bind(pipeline.handle(), pipeline_layout.get(), sets);
    recorder.push(pipeline_layout.get(), std::as_bytes(std::span(&push, 1)));
  }

  std::vector<uint32_t> values(const Device& device) const {
    std::vector<uint32_t> out(kCount);
    const Result<void> read = read_back(device, arena[0], std::as_writable_bytes(std::span(out)));
    EXPECT_TRUE(read) << read.error();
    return out;
  }
};

TEST_F(OnDevice, passes_that_write_the_same_buffer_run_one_after_the_other) {
  Result<Bench> bench = Bench::create(device());
  ASSERT_TRUE(bench) << bench.error();
  ASSERT_TRUE(upload(device(), bench->arena[0], bytes_of(std::vector<uint32_t>(Bench::kCount, 1))));
  uint32_t barriers = 0;
  const Result<void> ran = run_once(device(), "test", [&](VkCommandBuffer commands) {
    Recorder recorder(device(), commands);
    for (uint32_t i = 0; i < 3; ++i) {
      recorder.begin_pass("scale", {Bench::kValues, Bench::kValues, {}});
      bench->bind(recorder, bench->scale, i);
      recorder.dispatch((Bench::kCount + 63) / 64);
    }
    recorder.finish();
    barriers = recorder.barriers();
  });
  ASSERT_TRUE(ran) << ran.error();
  EXPECT_EQ(barriers, 2u);
  EXPECT_EQ(bench->values(device()), std::vector<uint32_t>(Bench::kCount, ((1 * 3 + 0) * 3 + 1) * 3 + 2));
}

TEST_F(OnDevice, a_dispatch_takes_its_size_from_what_a_pass_wrote) {
  Result<Bench> bench = Bench::create(device());
  ASSERT_TRUE(bench) << bench.error();
  ASSERT_TRUE(upload(device(), bench->arena[0], bytes_of(std::vector<uint32_t>(Bench::kCount, 1))));
  uint32_t barriers = 0;
  const Result<void> ran = run_once(device(), "test", [&](VkCommandBuffer commands) {
    Recorder recorder(device(), commands);
    for (uint32_t round = 0; round < 2; ++round) {
      recorder.begin_pass("arguments", {Bench::kValues, Bench::kArguments, {}});
      bench->bind(recorder, bench->arguments, 0);
      recorder.dispatch(1);
      recorder.begin_pass("scale", {Bench::kValues, Bench::kValues, Bench::kArguments});
      bench->bind(recorder, bench->scale, 2);
      recorder.dispatch_indirect(bench->arena[1].handle);
    }
    recorder.finish();
    barriers = recorder.barriers();
  });
  ASSERT_TRUE(ran) << ran.error();
  EXPECT_EQ(barriers, 3u);
  EXPECT_EQ(bench->values(device()), std::vector<uint32_t>(Bench::kCount, (1 * 3 + 2) * 3 + 2));
}

// The layer of Debian 12 lets one storage write follow another in silence, and counts a buffer that a shader both reads
// and writes as written; the read must therefore be one of a `readonly` buffer.
TEST_F(OnDevice, validation_speaks_when_a_barrier_is_left_out) {
  expects_messages_ = true;
  Result<Bench> bench = Bench::create(device());
  ASSERT_TRUE(bench) << bench.error();
  const Result<void> ran = run_once(device(), "test", [&](VkCommandBuffer commands) {
    Recorder recorder(device(), commands);
    for (const ComputePipeline* pipeline : {&bench->scale, &bench->arguments}) {
      recorder.begin_pass("silent", {});  // says that it touches nothing, which is not so
      bench->bind(recorder, *pipeline, 0);
      recorder.dispatch(1);
    }
  });
  ASSERT_TRUE(ran) << ran.error();
  ASSERT_FALSE(heard_.empty());
  EXPECT_NE(heard_[0].find("SYNC-HAZARD"), std::string::npos) << heard_[0];
  EXPECT_EQ(device().validation_messages(), heard_);
}

// What the layer lets pass is found by the checker that tests/solve/barriers_test.cpp relies on.
TEST_F(OnDevice, a_write_after_a_write_that_no_barrier_orders_is_found) {
  overheard::ear.begin();
  overheard::ear.get_instance_proc_addr = device().vk().vkGetInstanceProcAddr;
  const Result<std::unique_ptr<Device>> heard = Device::borrow({overheard::instance_function, device().instance(), device().physical(),
                                                                device().handle(), device().queue(), device().queue_family()});
  ASSERT_TRUE(heard) << heard.error();
  Result<Bench> bench = Bench::create(**heard);
  ASSERT_TRUE(bench) << bench.error();
  for (const bool says_so : {true, false}) {
    overheard::ear.stream.events.clear();
    const Result<void> ran = run_once(**heard, "test", [&](VkCommandBuffer commands) {
      Recorder recorder(**heard, commands);
      for (int pass = 0; pass < 2; ++pass) {
        recorder.begin_pass("scale", says_so ? Touches{Bench::kValues, Bench::kValues, {}} : Touches{});
        bench->bind(recorder, bench->scale, 0);
        recorder.dispatch(1);
      }
    });
    ASSERT_TRUE(ran) << ran.error();
    const std::vector<std::string> found = hazards::hazards_of(overheard::ear.stream);
    ASSERT_EQ(found.size(), says_so ? 0u : 3u);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const std::string kind = k == 0 ? "read after write" : k == 1 ? "write after read" : "write after write";
      EXPECT_TRUE(found[k].starts_with(kind + ": scale touches [0, 4000) of values after scale;")) << found[k];
    }
  }
}

TEST_F(OnDevice, every_pass_has_a_time_and_the_times_follow_each_other) {
  Result<Bench> bench = Bench::create(device());
  ASSERT_TRUE(bench) << bench.error();
  Result<Timestamps> timestamps = Timestamps::create(device(), "test", 3);
  ASSERT_TRUE(timestamps) << timestamps.error();
  EXPECT_EQ(timestamps->supported(), device().timestamp_period_ns() > 0);
  if (!timestamps->supported()) return;
  for (uint32_t round = 0; round < 2; ++round) {
    const Result<void> ran = run_once(device(), "test", [&](VkCommandBuffer commands) {
      timestamps->rewind(commands);
      EXPECT_TRUE(timestamps->read()->empty());
      Recorder recorder(device(), commands, &*timestamps);
      for (const char* name : {"one", "two", "one", "too many"}) {
        recorder.begin_pass(name, {Bench::kValues, Bench::kValues, {}});
        bench->bind(recorder, bench->scale, 0);
        recorder.dispatch(16);
      }
    });
    ASSERT_TRUE(ran) << ran.error();
    EXPECT_EQ(timestamps->dropped(), 1u);
    const Result<std::vector<PassTime>> times = timestamps->read();
    ASSERT_TRUE(times) << times.error();
    ASSERT_EQ(times->size(), 3u);
    EXPECT_EQ((*times)[0].name, (*times)[2].name);
    EXPECT_EQ(timestamps->names()[(*times)[1].name], "two");
    double last = 0;
    for (const PassTime& time : *times) {
      EXPECT_LE(last, time.begin_ms);
      EXPECT_LE(time.begin_ms, time.end_ms);
      last = time.end_ms;
    }
  }
}

TEST_F(OnDevice, a_pipeline_cache_comes_back_from_disk_and_a_damaged_one_is_ignored) {
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / ("weft_cache_" + std::to_string(std::random_device{}())) / "pipelines.cache";
  {
    Result<Bench> cold = Bench::create(device(), path);
    ASSERT_TRUE(cold) << cold.error();
    EXPECT_EQ(cold->cache.broken_files(), 0u);
    EXPECT_EQ(cold->cache.loaded_bytes(), 0u);
    const SpecializationConstant three{1, 3};
    ASSERT_TRUE(device().specializer().specialize(scale, {&three, 1}));
    const Result<void> saved = cold->cache.save();
    ASSERT_TRUE(saved) << saved.error();
  }
  const auto open = [&] {
    Result<Bench> bench = Bench::create(device(), path);
    EXPECT_TRUE(bench) << bench.error();
    return std::pair(bench->cache.loaded_bytes(), bench->cache.refusal());
  };
  std::ifstream in(path, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  const auto rewrite = [&](std::string_view text) {
    std::ofstream(path, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
  };
  EXPECT_GT(open().first, 0u);
  {
    const auto another = Device::create();
    ASSERT_TRUE(another) << another.error();
    EXPECT_EQ((*another)->specializer().modules(), 0u);
    const auto cache = PipelineCache::create(**another, path);
    ASSERT_TRUE(cache) << cache.error();
    EXPECT_EQ((*another)->specializer().modules(), device().specializer().modules()) << "what was specialised comes with it";
    const auto written = std::filesystem::last_write_time(path);
    ASSERT_TRUE(cache->save());
    EXPECT_EQ(std::filesystem::last_write_time(path), written) << "nothing has changed";
  }
  std::string flipped = whole;
  flipped[whole.size() - 1] ^= 1;
  rewrite(flipped);
  EXPECT_NE(open().second.find("checksum"), std::string::npos);
  std::string foreign = whole;
  foreign[8] ^= 1;  // the vendor
  rewrite(foreign);
  EXPECT_NE(open().second.find("another device"), std::string::npos);
  std::string longer = whole;
  longer[23] = 0x7f;  // of what was specialised
  rewrite(longer);
  EXPECT_NE(open().second.find("more bytes than all of it"), std::string::npos);
  for (const size_t length : {size_t{0}, size_t{7}, size_t{56}, whole.size() - 1}) {
    rewrite(std::string_view(whole).substr(0, length));
    const auto [loaded, refusal] = open();
    EXPECT_EQ(loaded, 0u);
    EXPECT_NE(refusal.find("pipelines.cache"), std::string::npos);
  }
  std::filesystem::remove_all(path.parent_path());
}

TEST_F(OnDevice, a_workgroup_above_the_limit_and_words_that_are_no_shader_are_refused) {
  Result<Bench> bench = Bench::create(device());
  ASSERT_TRUE(bench) << bench.error();
  const SpecializationConstant huge{0, 0xffffffff};
  const Result<ComputePipeline> wide =
      ComputePipeline::create(device(), nullptr, "wide", scale, {&huge, 1}, bench->pipeline_layout.get());
  ASSERT_FALSE(wide);
  EXPECT_NE(wide.error().find("shader wide has a workgroup of 4294967295"), std::string::npos) << wide.error();
  const std::vector<uint32_t> nonsense(64, 1);
  EXPECT_FALSE(ComputePipeline::create(device(), nullptr, "nonsense", nonsense, {}, bench->pipeline_layout.get()));
}

TEST_F(OnDevice, a_borrowed_device_is_left_as_it_was) {
  const BorrowedDevice lent{device().vk().vkGetInstanceProcAddr, device().instance(), device().physical(),
                            device().handle(), device().queue(), device().queue_family()};
  const auto scaled = [](const Device& on) {
    Result<Bench> bench = Bench::create(on);
    EXPECT_TRUE(bench) << bench.error();
    EXPECT_TRUE(upload(on, bench->arena[0], bytes_of(std::vector<uint32_t>(Bench::kCount, 2))));
    const Result<void> ran = run_once(on, "test", [&](VkCommandBuffer commands) {
      Recorder recorder(on, commands);
      recorder.begin_pass("scale", {Bench::kValues, Bench::kValues, {}});
      bench->bind(recorder, bench->scale, 1);
      recorder.dispatch(16);
    });
    EXPECT_TRUE(ran) << ran.error();
    return bench->values(on)[Bench::kCount - 1];
  };
  {
    const Result<std::unique_ptr<Device>> guest = Device::borrow(lent);
    ASSERT_TRUE(guest) << guest.error();
    EXPECT_TRUE((*guest)->is_borrowed());
    EXPECT_EQ(scaled(**guest), 7u);
  }
  EXPECT_EQ(scaled(device()), 7u);
}

}  // namespace
}  // namespace weft::compute
