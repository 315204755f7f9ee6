// A frame as a renderer sees it: buffers of the simulation to be bound as vertex buffers, with no copy in between.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>

#include "engine/vector.h"

namespace weft {

/// One attribute of every render vertex, all cloths one after another. The buffer stays the simulation's.
struct FrameView {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;                          // bytes to the first vertex
  std::uint32_t stride = 16;                        // bytes
  VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;  // w is not read
  std::uint32_t count = 0;                          // vertices
};

/// Where a collider of the scene stands in a frame, in the scene's order.
struct ColliderPose {
  Vec3 centre;           // m
  Vec3 normal{0, 1, 0};  // unit; planes only
  Rotation rotation{};   // from the shape's own axes: a capsule lies along y, a box has its sides along x, y, z; spheres spin by it
};

}  // namespace weft
