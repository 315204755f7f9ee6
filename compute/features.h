// Features of a device: the four that Weft cannot do without, and those that some readers of its vertices need (compute/readers.h).
#pragma once

#include <vulkan/vulkan_core.h>

#include <string>

#include "compute/functions.h"

namespace weft::compute {

struct Features {
  bool synchronization2 = false, timeline_semaphore = false, host_query_reset = false, scalar_block_layout = false;
  bool geometry_shader = false, tessellation_shader = false, task_shader = false, mesh_shader = false;
  bool ray_tracing_pipeline = false, acceleration_structure = false, buffer_device_address = false;
};

/// Those that a chain of Vulkan's structures says are on.
Features features_in(const void* chain);
Features enabled_features(const VkDeviceCreateInfo& created_with);
/// Of a device of Vulkan 1.3.
Features supported_features(const Functions& fn, VkPhysicalDevice physical);

/// Of the four that Weft needs, those that are off: "synchronization2 and timelineSemaphore"; empty if there are none.
std::string missing_of(const Features& features);

}  // namespace weft::compute
