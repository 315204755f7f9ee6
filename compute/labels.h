// Labels of passes in a command buffer, for RenderDoc and crash dumps: whether they may be recorded at all.
#pragma once

#include "compute/functions.h"

namespace weft::compute {

/// False for a Khronos validation layer before 1.3.243. A thread of its own retires the command buffers that have run, and erases
/// their labels without the lock under which labels are begun: where a handle is used again in that moment, the heap is corrupted.
/// Debian 12 has 1.3.239.
/// Source: Vulkan-ValidationLayers, 2a430d9d "layers: Fix debug label race conditions" (2023).
bool holds_labels(const VkPhysicalDeviceToolProperties& tool);

/// Whether every tool that is active on the device holds them, whoever has switched it on.
bool labels_hold(const Functions& fn, VkInstance instance, VkPhysicalDevice physical);

}  // namespace weft::compute
