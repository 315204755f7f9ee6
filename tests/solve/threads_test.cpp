// Threads, as simulation.h allows them: several simulations on one device, each driven by a thread of its own, and one simulation driven
// from threads other than its creator's, one at a time. Built and run under ThreadSanitizer too (weft_thread_tests),
// which sees Weft and the locks that it takes, and not what Mesa's software driver does inside.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "compute/commands.h"
#include "tests/support/sheets.h"

namespace weft {
namespace {

#ifdef WEFT_WITHOUT_VALIDATION   // layers are not instrumented, and have their own locks
class SharedDevice : public testing::Test {
 protected:
  void SetUp() override { device_ = must(compute::Device::create()); }
  const compute::Device& device() const { return *device_; }

 private:
  std::unique_ptr<compute::Device> device_;
};
#else
using SharedDevice = GpuTest;
#endif

constexpr int kThreadFrames = 8;
Scene hung_sheet(std::uint32_t cells) {
  Scene scene = sheet(cells);
  scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_low}));
  scene.colliders.push_back(sphere({0, -0.4f, 0}, 0.3));
  return scene;
}

std::uint64_t alone(const compute::Device& device, const Scene& scene) {
  const auto simulation = must(Simulation::create(device, scene));
  for (int frame = 0; frame < kThreadFrames; ++frame) must(simulation->advance(kFrame));
  return hash_of(*simulation);
}

TEST_F(SharedDevice, two_simulations_on_one_device_do_not_disturb_each_other) {
  const Scene scenes[] = {hung_sheet(6), hung_sheet(9)};
  std::uint64_t found[2] = {};
  std::vector<std::thread> threads;
  for (int k = 0; k < 2; ++k)
    threads.emplace_back([&, k] {
      const auto simulation = must(Simulation::create(device(), scenes[k]));   // also made and destroyed at the same time
      for (int frame = 0; frame < kThreadFrames; ++frame) {
        if (frame % 2 == 0) must(simulation->advance(kFrame));
        else must(simulation->submit(kFrame));
        must(simulation->read_vertex_positions());
      }
      found[k] = hash_of(*simulation);
    });
  for (std::thread& thread : threads) thread.join();
  // Afterwards, so that it is the threads that make what a device keeps for all.
  for (int k = 0; k < 2; ++k) EXPECT_EQ(found[k], alone(device(), scenes[k])) << k;
}

TEST_F(SharedDevice, a_simulation_goes_from_thread_to_thread) {
  const Scene scene = hung_sheet(6);
  auto simulation = must(Simulation::create(device(), scene));
  for (int frame = 0; frame < kThreadFrames; ++frame)
    std::thread([&, frame] {
      switch (frame % 3) {
        case 0: must(simulation->advance(kFrame)); break;
        case 1: must(simulation->submit(kFrame)); break;
        default:
          // The host's own command buffer, submitted by Weft's device.
          must(compute::run_once(device(), "recorded frame", [&](VkCommandBuffer c) { must(simulation->record(c, kFrame)); }));
      }
    }).join();
  EXPECT_EQ(hash_of(*simulation), alone(device(), scene));
  std::thread([&] { simulation.reset(); }).join();
}

}  // namespace
}  // namespace weft

#ifdef WEFT_WITHOUT_VALIDATION
// Mesa's own locks are not seen, so what one of its threads frees for another one looks like a race.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() { return "race:libvulkan_lvp.so"; }
#endif
