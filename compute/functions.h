// Vulkan's functions, as tables that belong to somebody.
//
// Weft links no loader: libvulkan.so.1 is opened at run time, so that a machine without it gets a sentence instead of a
// program that does not start. The functions are looked up per instance and per device and kept in a `Functions`; there
// is no global table, so that a host may run its own loader, with its own table, in the same process.
//
//   fn.vkCmdDispatch(commands, x, y, z);      // the names are Vulkan's own
//
// Based on: "Architecture of the Vulkan Loader Interfaces" (Khronos), on best application performance setup.
#pragma once

#include <vulkan/vulkan_core.h>

#include "compute/result.h"

namespace weft::compute {

// clang-format off

/// Callable before there is an instance.
#define WEFT_GLOBAL_FUNCTIONS(X) \
  X(vkCreateInstance) X(vkEnumerateInstanceVersion) X(vkEnumerateInstanceLayerProperties) \
  X(vkEnumerateInstanceExtensionProperties)

/// Looked up once per instance; Vulkan 1.1 has all of them.
#define WEFT_INSTANCE_FUNCTIONS(X) \
  X(vkDestroyInstance) X(vkEnumeratePhysicalDevices) X(vkEnumerateDeviceExtensionProperties) \
  X(vkGetPhysicalDeviceProperties) X(vkGetPhysicalDeviceProperties2) X(vkGetPhysicalDeviceFeatures) \
  X(vkGetPhysicalDeviceFeatures2) X(vkGetPhysicalDeviceMemoryProperties) X(vkGetPhysicalDeviceFormatProperties) \
  X(vkGetPhysicalDeviceQueueFamilyProperties) X(vkCreateDevice) X(vkGetDeviceProcAddr)

/// Looked up once per device; Vulkan 1.1 has all of them.
#define WEFT_DEVICE_FUNCTIONS(X) \
  X(vkDestroyDevice) X(vkDeviceWaitIdle) X(vkGetDeviceQueue) X(vkQueueSubmit) X(vkQueueWaitIdle) \
  X(vkAllocateMemory) X(vkFreeMemory) X(vkMapMemory) X(vkUnmapMemory) X(vkFlushMappedMemoryRanges) \
  X(vkInvalidateMappedMemoryRanges) \
  X(vkCreateBuffer) X(vkDestroyBuffer) X(vkGetBufferMemoryRequirements) X(vkBindBufferMemory) \
  X(vkCreateBufferView) X(vkDestroyBufferView) \
  X(vkCreateImage) X(vkDestroyImage) X(vkGetImageMemoryRequirements) X(vkBindImageMemory) \
  X(vkCreateImageView) X(vkDestroyImageView) X(vkGetImageSubresourceLayout) X(vkCreateSampler) X(vkDestroySampler) \
  X(vkCreateShaderModule) X(vkDestroyShaderModule) X(vkCreatePipelineCache) X(vkDestroyPipelineCache) \
  X(vkGetPipelineCacheData) X(vkCreateComputePipelines) X(vkCreateGraphicsPipelines) X(vkDestroyPipeline) \
  X(vkCreatePipelineLayout) X(vkDestroyPipelineLayout) X(vkCreateDescriptorSetLayout) \
  X(vkDestroyDescriptorSetLayout) X(vkCreateDescriptorPool) X(vkDestroyDescriptorPool) X(vkResetDescriptorPool) \
  X(vkAllocateDescriptorSets) X(vkFreeDescriptorSets) X(vkUpdateDescriptorSets) \
  X(vkCreateRenderPass) X(vkDestroyRenderPass) X(vkCreateFramebuffer) X(vkDestroyFramebuffer) \
  X(vkCreateCommandPool) X(vkDestroyCommandPool) X(vkResetCommandPool) X(vkAllocateCommandBuffers) \
  X(vkFreeCommandBuffers) X(vkBeginCommandBuffer) X(vkEndCommandBuffer) X(vkResetCommandBuffer) \
  X(vkCreateFence) X(vkDestroyFence) X(vkResetFences) X(vkGetFenceStatus) X(vkWaitForFences) \
  X(vkCreateEvent) X(vkDestroyEvent) X(vkGetEventStatus) X(vkResetEvent) X(vkCmdSetEvent) \
  X(vkCreateSemaphore) X(vkDestroySemaphore) X(vkCreateQueryPool) X(vkDestroyQueryPool) X(vkGetQueryPoolResults) \
  X(vkCmdBindPipeline) X(vkCmdBindDescriptorSets) X(vkCmdPushConstants) X(vkCmdDispatch) X(vkCmdDispatchIndirect) \
  X(vkCmdPipelineBarrier) X(vkCmdCopyBuffer) X(vkCmdFillBuffer) X(vkCmdUpdateBuffer) X(vkCmdCopyImage) \
  X(vkCmdCopyBufferToImage) X(vkCmdCopyImageToBuffer) X(vkCmdBlitImage) X(vkCmdResolveImage) \
  X(vkCmdClearColorImage) X(vkCmdResetQueryPool) X(vkCmdWriteTimestamp) X(vkCmdExecuteCommands) \
  X(vkCmdBeginRenderPass) X(vkCmdNextSubpass) X(vkCmdEndRenderPass) \
  X(vkCmdBindVertexBuffers) X(vkCmdBindIndexBuffer) X(vkCmdDraw) X(vkCmdDrawIndexed) X(vkCmdDrawIndirect) \
  X(vkCmdDrawIndexedIndirect) X(vkCmdSetViewport) X(vkCmdSetScissor) X(vkCmdSetDepthBias)

/// Of Vulkan 1.2 and 1.3, or of the KHR extension that they come from; null where the device has neither. Features that are enabled have
/// theirs (Device::features).
#define WEFT_LATER_DEVICE_FUNCTIONS(X) \
  X(vkGetSemaphoreCounterValue) X(vkWaitSemaphores) X(vkSignalSemaphore) \
  X(vkQueueSubmit2) X(vkCmdPipelineBarrier2) X(vkCmdBeginRendering) X(vkCmdEndRendering)

/// Null unless their extension was enabled.
#define WEFT_OPTIONAL_INSTANCE_FUNCTIONS(X) \
  X(vkCreateDebugUtilsMessengerEXT) X(vkDestroyDebugUtilsMessengerEXT) X(vkDestroySurfaceKHR) \
  X(vkGetPhysicalDeviceSurfaceSupportKHR) X(vkGetPhysicalDeviceSurfaceCapabilitiesKHR) \
  X(vkGetPhysicalDeviceSurfaceFormatsKHR) X(vkGetPhysicalDeviceSurfacePresentModesKHR)

#define WEFT_OPTIONAL_DEVICE_FUNCTIONS(X) \
  X(vkSetDebugUtilsObjectNameEXT) X(vkCmdBeginDebugUtilsLabelEXT) X(vkCmdEndDebugUtilsLabelEXT) \
  X(vkCreateSwapchainKHR) X(vkDestroySwapchainKHR) X(vkGetSwapchainImagesKHR) X(vkAcquireNextImageKHR) \
  X(vkQueuePresentKHR)

/// One table for one device. Plain data: copying it is cheap enough and owns nothing.
struct Functions {
  PFN_vkGetInstanceProcAddr vkGetInstanceProcAddr = nullptr;
#define WEFT_MEMBER(name) PFN_##name name = nullptr;
  WEFT_GLOBAL_FUNCTIONS(WEFT_MEMBER)
  WEFT_INSTANCE_FUNCTIONS(WEFT_MEMBER)
  WEFT_DEVICE_FUNCTIONS(WEFT_MEMBER)
  WEFT_LATER_DEVICE_FUNCTIONS(WEFT_MEMBER)
  WEFT_OPTIONAL_INSTANCE_FUNCTIONS(WEFT_MEMBER)
  WEFT_OPTIONAL_DEVICE_FUNCTIONS(WEFT_MEMBER)
#undef WEFT_MEMBER

  /// Each step needs the one before it. The sentence names the first function that is missing.
  Result<void> load_global(PFN_vkGetInstanceProcAddr from);
  Result<void> load_instance(VkInstance instance);
  Result<void> load_device(VkDevice device);

  /// Of Vulkan, whose functions the device has: the lower of the physical device's version and that which the host's VkApplicationInfo
  /// asked for. VK_API_VERSION_1_0 ... VK_API_VERSION_1_3.
  uint32_t version_of(VkDevice device) const;
};

// clang-format on

/// libvulkan.so.1, opened when asked for and closed with its owner.
class Loader {
 public:
  static Result<Loader> open();
  Loader(Loader&& other) noexcept;
  Loader& operator=(Loader&& other) noexcept;
  ~Loader();

  PFN_vkGetInstanceProcAddr get_instance_proc_addr() const { return get_instance_proc_addr_; }

 private:
  Loader() = default;
  void* library_ = nullptr;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr_ = nullptr;
};

/// A zeroed structure of Vulkan's that says what it is: typed<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO).
template <class T>
T typed(VkStructureType type) {
  T structure{};
  structure.sType = type;
  return structure;
}

/// "VK_ERROR_OUT_OF_DEVICE_MEMORY", or "VkResult -1234" for a code this header does not know.
std::string result_text(VkResult result);

/// A VkResult as a part of a sentence: its name, and the kind of error that it is.
class ResultName {
 public:
  explicit ResultName(VkResult result) : result_(result) {}
  ErrorKind error_kind() const;
  operator std::string() const { return result_text(result_); }
  friend std::ostream& operator<<(std::ostream& out, const ResultName& name) { return out << result_text(name.result_); }

 private:
  VkResult result_;
};
inline ResultName result_name(VkResult result) { return ResultName(result); }

}  // namespace weft::compute
