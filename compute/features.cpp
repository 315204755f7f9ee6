// Reads features from Vulkan's structures. See features.h.
#include "compute/features.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace weft::compute {
namespace {

template <class T>
const T& as(const VkBaseInStructure* in) {
  return *reinterpret_cast<const T*>(in);
}

void add(const VkPhysicalDeviceFeatures& core, Features& to) {
  to.geometry_shader |= core.geometryShader != VK_FALSE;
  to.tessellation_shader |= core.tessellationShader != VK_FALSE;
}

}  // namespace

// Each feature is told by its own structure or by that of its version.
Features features_in(const void* chain) {
  Features on;
  const auto add_to = [](bool& feature, VkBool32 told) { feature |= told != VK_FALSE; };
  for (auto* in = static_cast<const VkBaseInStructure*>(chain); in != nullptr; in = in->pNext) {
    switch (in->sType) {
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2: add(as<VkPhysicalDeviceFeatures2>(in).features, on); break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES: {
        const auto& told = as<VkPhysicalDeviceVulkan12Features>(in);
        add_to(on.timeline_semaphore, told.timelineSemaphore);
        add_to(on.buffer_device_address, told.bufferDeviceAddress);
        break;
      }
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES:
        add_to(on.synchronization2, as<VkPhysicalDeviceVulkan13Features>(in).synchronization2);
        add_to(on.dynamic_rendering, as<VkPhysicalDeviceVulkan13Features>(in).dynamicRendering);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES:
        add_to(on.dynamic_rendering, as<VkPhysicalDeviceDynamicRenderingFeatures>(in).dynamicRendering);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES:
        add_to(on.synchronization2, as<VkPhysicalDeviceSynchronization2Features>(in).synchronization2);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES:
        add_to(on.timeline_semaphore, as<VkPhysicalDeviceTimelineSemaphoreFeatures>(in).timelineSemaphore);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES:
        add_to(on.buffer_device_address, as<VkPhysicalDeviceBufferDeviceAddressFeatures>(in).bufferDeviceAddress);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT:
        add_to(on.task_shader, as<VkPhysicalDeviceMeshShaderFeaturesEXT>(in).taskShader);
        add_to(on.mesh_shader, as<VkPhysicalDeviceMeshShaderFeaturesEXT>(in).meshShader);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR:
        add_to(on.ray_tracing_pipeline, as<VkPhysicalDeviceRayTracingPipelineFeaturesKHR>(in).rayTracingPipeline);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR:
        add_to(on.acceleration_structure, as<VkPhysicalDeviceAccelerationStructureFeaturesKHR>(in).accelerationStructure);
        break;
      default: break;
    }
  }
  return on;
}

Features enabled_features(const VkDeviceCreateInfo& created_with) {
  Features on = features_in(created_with.pNext);
  if (created_with.pEnabledFeatures != nullptr) add(*created_with.pEnabledFeatures, on);
  return on;
}

Features supported_features(const Functions& fn, VkPhysicalDevice physical, uint32_t version) {
  auto all = typed<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  auto v12 = typed<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  auto v13 = typed<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  auto mesh = typed<VkPhysicalDeviceMeshShaderFeaturesEXT>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT);
  auto rays = typed<VkPhysicalDeviceRayTracingPipelineFeaturesKHR>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR);
  auto structures =
      typed<VkPhysicalDeviceAccelerationStructureFeaturesKHR>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR);
  void** last = &all.pNext;
  const auto ask = [&](auto& structure) {
    *last = &structure;
    last = &structure.pNext;
  };
  // Structures of a version or an extension may be asked for only where there is that.
  if (version >= VK_API_VERSION_1_2) ask(v12);
  if (version >= VK_API_VERSION_1_3) ask(v13);
  uint32_t count = 0;
  fn.vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> offered(count);
  fn.vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, offered.data());
  const auto ask_too = [&](std::string_view extension, auto& structure) {
    if (std::any_of(offered.begin(), offered.end(), [&](const auto& one) { return extension == one.extensionName; })) ask(structure);
  };
  ask_too(VK_EXT_MESH_SHADER_EXTENSION_NAME, mesh);
  ask_too(VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME, rays);
  ask_too(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME, structures);
  fn.vkGetPhysicalDeviceFeatures2(physical, &all);
  return features_in(&all);
}

}  // namespace weft::compute
