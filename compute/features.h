// Features of a device: what Weft makes use of where it is enabled, and what some readers of its vertices need (compute/readers.h). Weft
// needs none of them.
#pragma once

#include <vulkan/vulkan_core.h>

#include "compute/functions.h"

namespace weft::compute {

struct Features {
  bool synchronization2 = false;     ///< or compute/synchronization.h says how barriers and submits get coarser
  bool timeline_semaphore = false;   ///< or Weft waits for its frames by fences, and Simulation::ready_semaphore() is VK_NULL_HANDLE
  bool dynamic_rendering = false;    ///< or Shading draws no pictures
  bool geometry_shader = false, tessellation_shader = false, task_shader = false, mesh_shader = false;
  bool ray_tracing_pipeline = false, acceleration_structure = false, buffer_device_address = false;
};

/// Those that a chain of Vulkan's structures says are on.
Features features_in(const void* chain);
Features enabled_features(const VkDeviceCreateInfo& created_with);
/// Of a device that is used as one of Vulkan `version`, at least 1.1.
Features supported_features(const Functions& fn, VkPhysicalDevice physical, uint32_t version);

}  // namespace weft::compute
