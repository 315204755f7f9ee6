// A frame as a renderer sees it: buffers of the simulation to be bound as vertex buffers, with no copy in between.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>

#include "engine/collider_pose.h"

namespace weft {

/// One attribute of every render vertex, all cloths one after another. The buffer stays the simulation's.
struct FrameView {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;                          // bytes to the first vertex
  std::uint32_t stride = 16;                        // bytes
  VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;  // w is not read
  std::uint32_t count = 0;                          // vertices
  /// What the buffer was created for: vertex and storage buffer, source and destination of copies, and
  /// SimulationOptions::vertex_usage. Written by compute shaders. With VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT its address is
  /// vkGetBufferDeviceAddress's, plus the offset.
  VkBufferUsageFlags usage = 0;
};

}  // namespace weft
