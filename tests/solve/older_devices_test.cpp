// Hosts whose devices have less than Weft makes use of: features off one by one and all off, features that come from extensions, and
// instances that ask for Vulkan 1.1 and 1.2, where functions of later versions are null. Frames of all three ways are the same bits as on a
// device that has everything, and validation, which knows what each of these devices has, says nothing.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>

#include "compute/inventory.h"
#include "compute/synchronization.h"
#include "engine/shading/shading.h"
#include "tests/support/every_method.h"
#include "tests/support/lent_device.h"
#include "tests/support/overheard_vulkan.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

/// What a host asks of Vulkan.
struct Asked {
  const char* name;
  std::uint32_t version = VK_API_VERSION_1_3;
  bool synchronization2 = false, timeline_semaphore = false, host_query_reset = false, scalar_block_layout = false;
  bool by_extensions = false;   // the first two
};

constexpr std::uint32_t k11 = VK_API_VERSION_1_1, k12 = VK_API_VERSION_1_2, k13 = VK_API_VERSION_1_3;
constexpr Asked kHosts[] = {
    {"no_synchronization2", k13, false, true, true, true},
    {"no_timeline_semaphore", k13, true, false, true, true},
    {"no_host_query_reset", k13, true, true, false, true},
    {"no_scalar_block_layout", k13, true, true, true, false},
    {"none", k13},
    {"none_of_1_2", k12},
    {"timeline_semaphore_of_1_2", k12, false, true},
    {"none_of_1_1", k11},
    {"extensions_of_1_1", k11, true, true, false, false, true},
};

/// A host with an instance of its own, in which validation is on: one message fails the test.
class OlderHost {
 public:
  explicit OlderHost(const Asked& asked, PFN_vkGetInstanceProcAddr function = nullptr) {
    compute::DeviceChoice choice;
    choice.validation = true;
    choice.on_validation_message = [](const std::string& message) { ADD_FAILURE() << message; };
    instance_.emplace(must(compute::Instance::create(choice, asked.version)));
    const compute::Functions& vk = instance_->functions();
    std::vector<const char*> extensions;
    void* chain = nullptr;
    const auto enable = [&](auto& structure) {
      structure.pNext = chain;
      chain = &structure;
    };
    auto v13 = compute::typed<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
    auto v12 = compute::typed<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
    auto barriers = compute::typed<VkPhysicalDeviceSynchronization2Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES);
    auto timelines =
        compute::typed<VkPhysicalDeviceTimelineSemaphoreFeatures>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES);
    v13.synchronization2 = barriers.synchronization2 = asked.synchronization2;
    v12.timelineSemaphore = timelines.timelineSemaphore = asked.timeline_semaphore;
    v12.hostQueryReset = asked.host_query_reset;
    v12.scalarBlockLayout = asked.scalar_block_layout;
    if (asked.by_extensions) {
      extensions = {VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME, VK_KHR_TIMELINE_SEMAPHORE_EXTENSION_NAME};
      enable(barriers);
      enable(timelines);
    } else {
      if (asked.version >= k13) enable(v13);
      if (asked.version >= k12) enable(v12);
    }
    const compute::Device& best = *kGpu->device();
    device_.emplace(LentDevice::Host{vk, instance_->handle(), same_as(best), best.queue_family()}, chain, VkPhysicalDeviceFeatures{},
                    extensions, function);
  }

  const compute::Device& device() const { return **device_; }

 private:
  // The physical device of this instance that the tests use in theirs.
  VkPhysicalDevice same_as(const compute::Device& other) const {
    std::uint32_t count = 0;
    const compute::Functions& vk = instance_->functions();
    vk.vkEnumeratePhysicalDevices(instance_->handle(), &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    vk.vkEnumeratePhysicalDevices(instance_->handle(), &count, devices.data());
    for (const VkPhysicalDevice device : devices) {
      VkPhysicalDeviceProperties properties{};
      vk.vkGetPhysicalDeviceProperties(device, &properties);
      if (other.name() == properties.deviceName) return device;
    }
    throw std::runtime_error("no such device in another instance");
  }

  std::optional<compute::Instance> instance_;
  std::optional<LentDevice> device_;
};

/// Contacts that soon have too little room, with colliders that are told what they are given, and another method.
std::vector<Subject> few_subjects() {
  std::vector<Subject> few = subjects();
  std::erase_if(few, [](const Subject& subject) {
    return subject.name != std::string_view("contacts") && subject.name != std::string_view("gauss_seidel on levels");
  });
  EXPECT_EQ(few.size(), 2u);
  few.back().scene.reactions = true;
  return few;
}

bool same_bits(const std::vector<gpu::vec4>& a, const std::vector<gpu::vec4>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(gpu::vec4)) == 0;
}

class OlderDevices : public GpuTest {
 protected:
  void TearDown() override {
    std::filesystem::remove(cache_);
    GpuTest::TearDown();
  }

  /// All that frames leave behind in these ways, one after the other from the same start. Of those that Weft submits two are under way.
  std::vector<gpu::vec4> played(const compute::Device& device, const Scene& scene, std::span<const Way> ways = kWays) {
    SimulationOptions options;
    options.pipeline_cache = cache_;
    const auto simulation = must(Simulation::create(device, scene, options));
    const Snapshot start = must(simulation->save());
    std::vector<gpu::vec4> all;
    for (const Way way : ways) {
      must(simulation->restore(start));
      for (int k = 0; k < 3; ++k) {
        run_frame(device, *simulation, way);
        (void)simulation->counts();   // of the last one that is known to be done
      }
      for (const auto& read : {simulation->read_positions(), simulation->read_velocities()})
        for (const gpu::vec4& v : must(read)) all.push_back(v);
      for (const auto& read : {simulation->read_vertex_positions(), simulation->read_vertex_normals()})
        for (const Vec3& v : must(read)) all.push_back({v.x, v.y, v.z, 0});
      for (const Reaction& given : simulation->take_reactions())
        all.push_back({given.impulse.x, given.impulse.y, given.impulse.z, given.angular_impulse.x});
    }
    device.vk().vkQueueWaitIdle(device.queue());   // before a simulation goes whose frames signal semaphores (engine/simulation.h)
    return all;
  }

  // What one device has specialised another need not.
  const std::filesystem::path cache_ = std::filesystem::path(testing::TempDir()) / ("weft_older_devices_" + std::to_string(getpid()));
};

TEST_F(OlderDevices, frames_are_the_same_bits_in_all_three_ways) {
  for (const Subject& subject : few_subjects()) {
    const std::vector<gpu::vec4> expected = played(device(), subject.scene);
    for (const Asked& asked : kHosts) {
      SCOPED_TRACE(asked.name);
      const OlderHost host(asked);
      EXPECT_EQ(host.device().features().synchronization2, asked.synchronization2);
      EXPECT_EQ(host.device().features().timeline_semaphore, asked.timeline_semaphore);
      EXPECT_TRUE(same_bits(played(host.device(), subject.scene), expected)) << subject.name;
    }
  }
}

class OldestDevice : public OlderDevices {
 protected:
  const Asked asked_{"none_of_1_1", k11};
};

TEST_F(OldestDevice, other_methods_give_the_same_bits) {
  const OlderHost host(asked_);
  const Way ways[] = {Way::submit};
  for (const Subject& subject : subjects()) {
    const std::string_view name = subject.name;
    if (name != "strands" && name != "chebyshev" && name != "hinges" && name != "verlet" && name != "implicit") continue;
    EXPECT_TRUE(same_bits(played(host.device(), subject.scene, ways), played(device(), subject.scene, ways))) << name;
  }
}

TEST_F(OldestDevice, without_timeline_semaphores_frames_are_counted_and_have_none) {
  const OlderHost host(asked_);
  const auto simulation = must(Simulation::create(host.device(), moving()));
  for (std::uint64_t k = 1; k < 4; ++k) {
    must(simulation->submit(kFrame));
    EXPECT_EQ(simulation->ready_value(), k);
  }
  EXPECT_EQ(simulation->ready_semaphore(), VkSemaphore(VK_NULL_HANDLE));
}

// The software driver's thread has no look at a fence after it was waited for. With semaphores it has (Limitations).
TEST_F(OldestDevice, a_simulation_may_be_destroyed_without_waiting_for_the_queue) {
  const OlderHost host(asked_);
  for (int k = 0; k < 10; ++k) {
    const auto simulation = must(Simulation::create(host.device(), sheet(2)));
    must(simulation->submit(kFrame));
    must(simulation->submit(kFrame));
  }
}

TEST_F(OldestDevice, passes_are_timed) {
  const OlderHost host(asked_);
  SimulationOptions options;
  options.timings = true;
  const auto simulation = must(Simulation::create(host.device(), moving(), options));
  for (int k = 0; k < 3; ++k) must(simulation->submit(kFrame));
  must(simulation->read_positions());
  EXPECT_FALSE(simulation->timings().empty());
  EXPECT_GT(simulation->gpu_milliseconds(), 0);
}

TEST_F(OldestDevice, pictures_are_refused) {
  const OlderHost host(asked_);
  const auto simulation = must(Simulation::create(host.device(), moving()));
  const RenderMesh mesh = simulation->meshes()[0].render;
  auto lent = must(compute::Device::borrow({host.device().vk().vkGetInstanceProcAddr, host.device().instance(), host.device().physical(),
                                            host.device().handle(), host.device().queue(), host.device().queue_family()}));
  const Appearance look;
  const ShadedCloth cloth{&mesh, &look};
  const auto shading = Shading::create(*lent, simulation->scene(), {&cloth, 1}, {64, 64});
  ASSERT_FALSE(shading);
  EXPECT_NE(shading.error().find("synchronization2 and dynamicRendering"), std::string::npos) << shading.error();
}

// Stages and accesses get coarser, and nothing is lost on the way.
TEST_F(OldestDevice, no_barrier_is_missing) {
  using overheard::ear;
  for (const Subject& subject : few_subjects()) {
    SCOPED_TRACE(subject.name);
    ear.begin();
    ear.get_instance_proc_addr = device().vk().vkGetInstanceProcAddr;
    ear.computes = true;
    const OlderHost host(asked_, overheard::instance_function);
    const auto simulation = must(Simulation::create(host.device(), subject.scene));
    const auto draw = [&](VkCommandBuffer commands) {
      for (const FrameView& view : {simulation->positions(), simulation->normals()})
        ear.touches(commands, "draw", view.buffer, VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT);
    };
    for (const Way way : {Way::submit, Way::submit, Way::advance, Way::record, Way::record, Way::submit}) {
      run_frame(host.device(), *simulation, way);
      must(compute::run_once(host.device(), "host", draw));
    }
    EXPECT_GT(ear.stream.events.size(), 100u);
    for (const std::string& hazard : hazards::hazards_of(ear.stream)) ADD_FAILURE() << hazard;
  }
}

// Vulkan as an instance finds it that asks for 1.0. Its functions carry no user pointer, hence the variables.
PFN_vkGetInstanceProcAddr real_instance_function = nullptr;
PFN_vkGetDeviceProcAddr real_device_function = nullptr;
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function_of_1_0(VkDevice device, const char* name) {
  for (const std::string_view later : {"vkGetBufferMemoryRequirements2", "vkGetSemaphoreCounterValue", "vkCmdPipelineBarrier2"})
    if (later == name) return nullptr;
  return real_device_function(device, name);
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_function_of_1_0(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction real = real_instance_function(instance, name);
  if (std::string_view(name) != "vkGetDeviceProcAddr") return real;
  real_device_function = reinterpret_cast<PFN_vkGetDeviceProcAddr>(real);
  return reinterpret_cast<PFN_vkVoidFunction>(device_function_of_1_0);
}

TEST_F(OldestDevice, an_instance_of_vulkan_1_0_is_refused) {
  real_instance_function = device().vk().vkGetInstanceProcAddr;
  const auto lent = compute::Device::borrow({instance_function_of_1_0, device().instance(), device().physical(), device().handle(),
                                             device().queue(), device().queue_family()});
  ASSERT_FALSE(lent);
  EXPECT_EQ(lent.error(), "the device lent to Weft, " + device().name() + ", cannot be used: it has Vulkan 1.0.0, and Weft needs 1.1");
}

TEST(Synchronization, what_becomes_coarser_has_all_of_what_it_was) {
  compute::Features features;
  EXPECT_EQ(compute::coarser_stages(VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, features),
            VkPipelineStageFlags(VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT));
  EXPECT_EQ(compute::coarser_stages(VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT | VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, features),
            VkPipelineStageFlags(VK_PIPELINE_STAGE_VERTEX_INPUT_BIT));
  EXPECT_EQ(compute::coarser_stages(VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_HOST_BIT, features),
            VkPipelineStageFlags(VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_HOST_BIT));
  EXPECT_EQ(compute::coarser_stages(VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT, features),
            VkPipelineStageFlags(VK_PIPELINE_STAGE_VERTEX_SHADER_BIT));
  features.geometry_shader = true;
  EXPECT_EQ(compute::coarser_stages(VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT, features),
            VkPipelineStageFlags(VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_GEOMETRY_SHADER_BIT));
  EXPECT_EQ(compute::coarser_accesses(VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_HOST_READ_BIT),
            VkAccessFlags(VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_HOST_READ_BIT));
  EXPECT_EQ(compute::coarser_accesses(VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT), VkAccessFlags(VK_ACCESS_SHADER_WRITE_BIT));
  EXPECT_EQ(compute::coarser_accesses(VK_ACCESS_2_SHADER_SAMPLED_READ_BIT), VkAccessFlags(VK_ACCESS_SHADER_READ_BIT));
}

}  // namespace
}  // namespace weft
