// Barriers and submits, on devices with the feature synchronization2 and on those without it.
//
// Weft says what waits for what in the words of synchronization2, whose stages and accesses are finer. Without the feature they become
// the nearest ones of Vulkan 1.0 that have them all: copies become transfers, and reads of attributes become vertex input. What a signal
// waits for cannot be said there: it is all that is earlier on the queue.
#pragma once

#include <vulkan/vulkan_core.h>

#include "compute/features.h"
#include "compute/functions.h"

namespace weft::compute {

class Device;

void record_barrier(const Device& device, VkCommandBuffer commands, const VkMemoryBarrier2& barrier);

/// As vkQueueSubmit2 with one batch, and with chains (pNext) of no structure. Throws std::bad_alloc.
VkResult submit_to(const Functions& fn, const Features& features, VkQueue queue, const VkSubmitInfo2& work, VkFence fence);

/// The stages of Vulkan 1.0 that have all of these; `features` tells which shaders there may be before rasterization.
VkPipelineStageFlags coarser_stages(VkPipelineStageFlags2 stages, const Features& features);
VkAccessFlags coarser_accesses(VkAccessFlags2 accesses);

}  // namespace weft::compute
