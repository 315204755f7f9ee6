// A buffer of a host that skins on its own GPU: where a cloth's or a mesh collider's points are when a frame ends.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>

namespace weft {

/// Where a host's own skinning on the GPU has a mesh (Simulation::set_targets): an entry a render vertex, in the order of positions() from
/// the mesh's first vertex on (CookedFabric says which), 16 bytes apart: x, y and z as floats, and four bytes that are not read.
///
/// Buffers are of Simulation::device(), created with VK_BUFFER_USAGE_TRANSFER_SRC_BIT, and owned by Weft's queue family where they are
/// exclusive. The next frame that takes a substep copies from them where it begins, and from nowhere else; Weft never writes them.
///   what writes them     earlier on Weft's queue in compute shaders or copies (or by the CPU before advance or submit): the host owes nothing.
///                        In other stages: a barrier to VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT. On another
///                        queue: a semaphore on which that frame waits at this stage (submit's `waits`, or the host's own submit)
///   written again by     later compute shaders or copies on the queue: whenever they are submitted after the frame; other stages: after a
///                        barrier from ALL_TRANSFER; the CPU, another queue, or destroyed: when the frame is done
struct TargetBuffer {
  VkBuffer positions = VK_NULL_HANDLE;
  VkDeviceSize positions_offset = 0;     // bytes
  VkBuffer normals = VK_NULL_HANDLE;     // which only backstops read; any length. VK_NULL_HANDLE: those that joints have
  VkDeviceSize normals_offset = 0;
  std::uint32_t vertices = 0;            // for comparison: the mesh's render vertices
};

}  // namespace weft
