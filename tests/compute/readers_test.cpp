// What a host may say of its readers, and what is refused: bits that Vulkan has no buffers for, that do not go together, or that take
// what the device has not.
#include "compute/readers.h"

#include <gtest/gtest.h>

#include <cstring>

#include "compute/commands.h"
#include "compute/recorder.h"
#include "tests/support/lent_device.h"

namespace weft::compute {
namespace {

constexpr VkPipelineStageFlags2 kDraws = VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, kSkins = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                kCopies = VK_PIPELINE_STAGE_2_COPY_BIT, kGeometry = VK_PIPELINE_STAGE_2_GEOMETRY_SHADER_BIT,
                                kBuilds = VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                                kRays = VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR;
constexpr VkAccessFlags2 kVertices = VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT, kStored = VK_ACCESS_2_SHADER_STORAGE_READ_BIT,
                         kShaders = VK_ACCESS_2_SHADER_READ_BIT, kCopied = VK_ACCESS_2_TRANSFER_READ_BIT,
                         kMemory = VK_ACCESS_2_MEMORY_READ_BIT;

std::string refusal(const Device& device, VkPipelineStageFlags2 stages, VkAccessFlags2 accesses) {
  const Result<void> checked = check_readers(device, {stages, accesses});
  return checked ? std::string() : checked.error();
}
std::string refusal(const Device& device, VkBufferUsageFlags usage) {
  const Result<void> checked = check_usage(device, usage);
  return checked ? std::string() : checked.error();
}

class ReadersOf : public OnDevice {};

TEST_F(ReadersOf, usual_ones_are_accepted) {
  EXPECT_EQ(refusal(device(), kSkins, kStored), "");
  EXPECT_EQ(refusal(device(), kCopies, kCopied), "");
  EXPECT_EQ(refusal(device(), kSkins | kCopies, kShaders | kCopied), "");
  EXPECT_EQ(refusal(device(), kSkins | kCopies, kMemory), "");
  EXPECT_EQ(refusal(device(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, kMemory), "");
  EXPECT_EQ(refusal(device(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, kStored | kCopied), "");
  if (!device().draws()) return;
  EXPECT_EQ(refusal(device(), kDraws, kVertices), "");
  EXPECT_EQ(refusal(device(), VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, kVertices | kStored), "");
  EXPECT_EQ(refusal(device(), VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT | kSkins, kVertices | kStored), "");
}

TEST_F(ReadersOf, none_and_unknown_ones_are_refused) {
  EXPECT_EQ(refusal(device(), 0, kStored), "readers: no stage is named");
  EXPECT_EQ(refusal(device(), kSkins, 0), "readers: no access is named");
  EXPECT_EQ(refusal(device(), kSkins | VkPipelineStageFlags2{1} << 60, kStored),
            "readers: the stages 0x1000000000000000 are none in which a buffer is read");
  EXPECT_EQ(refusal(device(), kSkins | VK_PIPELINE_STAGE_2_HOST_BIT, kStored),
            "readers: the stages 0x4000 are none in which a buffer is read");
  EXPECT_EQ(refusal(device(), kSkins, kStored | VkAccessFlags2{1} << 60),
            "readers: the accesses 0x1000000000000000 are none by which a buffer is read");
  EXPECT_EQ(refusal(device(), kSkins, kStored | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT),
            "readers: the accesses 0x400000000 are none by which a buffer is read");
}

TEST_F(ReadersOf, stages_and_accesses_that_do_not_go_together_are_refused) {
  EXPECT_EQ(refusal(device(), kSkins, kStored | kCopied),
            "readers: none of the stages VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT has the access VK_ACCESS_2_TRANSFER_READ_BIT");
  EXPECT_EQ(refusal(device(), kSkins | kCopies, kCopied),
            "readers: VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT has none of the accesses VK_ACCESS_2_TRANSFER_READ_BIT");
  if (!device().draws()) return;
  EXPECT_EQ(refusal(device(), kDraws, kStored),
            "readers: VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT has none of the accesses VK_ACCESS_2_SHADER_STORAGE_READ_BIT");
}

// Every stage and every access alone: what is accepted is accepted by Vulkan, too, whose validation looks at the barrier.
TEST_F(ReadersOf, what_is_accepted_vulkan_accepts) {
  int accepted = 0;
  for (int stage = 0; stage < 48; ++stage)
    for (int access = 0; access < 48; ++access) {
      const Readers readers{VkPipelineStageFlags2{1} << stage, VkAccessFlags2{1} << access};
      if (!check_readers(device(), readers)) continue;
      ++accepted;
      must(run_once(device(), "readers", [&](VkCommandBuffer commands) {
        Recorder recorder(device(), commands);
        recorder.barrier({Use::compute, readers}, Use::compute);
        recorder.barrier(Use::compute, {Use::transfer, readers});
      }));
    }
  EXPECT_GT(accepted, device().draws() ? 40 : 15);
}

TEST_F(ReadersOf, what_takes_a_feature_is_refused_unless_the_host_has_enabled_it) {
  const auto needs = [&](const char* name, const char* feature) {
    return std::string(name) + " takes the feature " + feature + ", which is not enabled on " + device().name();
  };
  const std::string geometry = needs("readers: VK_PIPELINE_STAGE_2_GEOMETRY_SHADER_BIT", "geometryShader"),
                    address = needs("vertex_usage: VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT", "bufferDeviceAddress");
  EXPECT_EQ(refusal(device(), kBuilds, kShaders),
            needs("readers: VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR", "accelerationStructure"));
  EXPECT_EQ(refusal(device(), kRays, kStored), needs("readers: VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR", "rayTracingPipeline"));
  EXPECT_EQ(refusal(device(), VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR),
            needs("vertex_usage: VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR", "accelerationStructure"));
  EXPECT_EQ(refusal(device(), VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT), address);
  EXPECT_EQ(refusal(device(), 0), "");
  EXPECT_EQ(refusal(device(), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT), "");
  EXPECT_EQ(refusal(device(), VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT),
            "vertex_usage: the bits 0x400 are none for which a buffer of vertices is created");

  VkPhysicalDeviceFeatures core{};
  device().vk().vkGetPhysicalDeviceFeatures(device().physical(), &core);
  if (!core.geometryShader || !device().draws()) GTEST_SKIP() << "no geometry shaders here";
  EXPECT_EQ(refusal(device(), kGeometry, kStored), geometry);
  core = {};
  core.geometryShader = VK_TRUE;
  const LentDevice with(device(), {}, core), without(device());
  EXPECT_EQ(refusal(*with, kGeometry, kStored), "");
  EXPECT_EQ(refusal(*without, kGeometry, kStored), geometry);
  EXPECT_EQ(refusal(*without, VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT), address);
}

TEST_F(ReadersOf, a_host_that_does_not_tell_is_taken_to_have_enabled_what_there_is) {
  const auto silent = must(Device::borrow({device().vk().vkGetInstanceProcAddr, device().instance(), device().physical(), device().handle(),
                                           device().queue(), device().queue_family()}));
  const Features& there = device().description().features;
  EXPECT_EQ((*silent).features().synchronization2, there.synchronization2);
  EXPECT_EQ((*silent).features().timeline_semaphore, there.timeline_semaphore);
  EXPECT_EQ(refusal(*silent, VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT).empty(), there.buffer_device_address);
  EXPECT_EQ(refusal(*silent, kBuilds, kShaders).empty(), there.acceleration_structure);
}

// Each feature by each structure that may tell of it.
TEST(FeaturesOf, a_device_are_read_wherever_they_stand) {
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{};
  structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR;
  structures.accelerationStructure = VK_TRUE;
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR rays{};
  rays.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR;
  rays.pNext = &structures;
  rays.rayTracingPipeline = VK_TRUE;
  VkPhysicalDeviceMeshShaderFeaturesEXT mesh{};
  mesh.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT;
  mesh.pNext = &rays;
  mesh.meshShader = VK_TRUE;
  VkPhysicalDeviceBufferDeviceAddressFeatures address{};
  address.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES;
  address.pNext = &mesh;
  address.bufferDeviceAddress = VK_TRUE;
  VkPhysicalDeviceFeatures2 core{};
  core.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  core.pNext = &address;
  core.features.tessellationShader = VK_TRUE;
  VkDeviceCreateInfo created{};
  created.pNext = &core;
  const Features on = enabled_features(created);
  EXPECT_TRUE(on.acceleration_structure && on.ray_tracing_pipeline && on.mesh_shader && on.buffer_device_address && on.tessellation_shader);
  EXPECT_FALSE(on.task_shader || on.geometry_shader || on.synchronization2);
  EXPECT_FALSE(enabled_features({}).buffer_device_address);
}

// A driver whose queues only compute. Vulkan's functions carry no user pointer, hence the variables.
PFN_vkGetInstanceProcAddr real_function = nullptr;
PFN_vkGetPhysicalDeviceQueueFamilyProperties real_families = nullptr;

VKAPI_ATTR void VKAPI_CALL families_that_compute(VkPhysicalDevice physical, uint32_t* count, VkQueueFamilyProperties* families) {
  real_families(physical, count, families);
  for (uint32_t k = 0; families != nullptr && k < *count; ++k) families[k].queueFlags &= ~VkQueueFlags{VK_QUEUE_GRAPHICS_BIT};
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL function_of_a_computing_driver(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction real = real_function(instance, name);
  if (std::strcmp(name, "vkGetPhysicalDeviceQueueFamilyProperties") != 0) return real;
  real_families = reinterpret_cast<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(real);
  return reinterpret_cast<PFN_vkVoidFunction>(families_that_compute);
}

TEST_F(ReadersOf, stages_of_draws_are_refused_where_the_queue_only_computes) {
  real_function = device().vk().vkGetInstanceProcAddr;
  const auto computes = must(Device::borrow({function_of_a_computing_driver, device().instance(), device().physical(), device().handle(),
                                             device().queue(), device().queue_family()}));
  EXPECT_EQ(refusal(*computes, kDraws, kVertices),
            "readers: VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT takes a queue that draws; queue family " +
                std::to_string(device().queue_family()) + " of " + device().name() + " does not");
  EXPECT_EQ(refusal(*computes, kSkins | kCopies, kStored | kCopied), "");
  EXPECT_EQ(refusal(*computes, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, kMemory), "");
}

}  // namespace
}  // namespace weft::compute
