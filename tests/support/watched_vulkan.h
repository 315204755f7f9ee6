// Vulkan as a host hands it over, with an ear on what a guest must not call: the end and the idling of what is not its own.
// Submits are counted and passed on. Vulkan's functions carry no user pointer, hence the variable.
#pragma once

#include <vulkan/vulkan_core.h>

#include <atomic>
#include <cstring>

namespace weft {

struct Watch {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  PFN_vkGetDeviceProcAddr get_device_proc_addr = nullptr;
  PFN_vkQueueSubmit2 submit = nullptr;
  std::atomic<int> submits = 0, forbidden = 0;
};
inline Watch watch;

inline VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance, const VkAllocationCallbacks*) { ++watch.forbidden; }
inline VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice, const VkAllocationCallbacks*) { ++watch.forbidden; }
inline VKAPI_ATTR VkResult VKAPI_CALL device_wait_idle(VkDevice) { return ++watch.forbidden, VK_SUCCESS; }
inline VKAPI_ATTR VkResult VKAPI_CALL queue_wait_idle(VkQueue) { return ++watch.forbidden, VK_SUCCESS; }
inline VKAPI_ATTR VkResult VKAPI_CALL queue_submit2(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* work, VkFence fence) {
  ++watch.submits;
  return watch.submit(queue, count, work, fence);
}

inline VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL watched_device_function(VkDevice device, const char* name) {
  const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
  if (is("vkDestroyDevice")) return reinterpret_cast<PFN_vkVoidFunction>(destroy_device);
  if (is("vkDeviceWaitIdle")) return reinterpret_cast<PFN_vkVoidFunction>(device_wait_idle);
  if (is("vkQueueWaitIdle")) return reinterpret_cast<PFN_vkVoidFunction>(queue_wait_idle);
  if (!is("vkQueueSubmit2")) return watch.get_device_proc_addr(device, name);
  watch.submit = reinterpret_cast<PFN_vkQueueSubmit2>(watch.get_device_proc_addr(device, name));
  return reinterpret_cast<PFN_vkVoidFunction>(queue_submit2);
}

inline VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL watched_function(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkDestroyInstance") == 0) return reinterpret_cast<PFN_vkVoidFunction>(destroy_instance);
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(watched_device_function);
  return watch.get_instance_proc_addr(instance, name);
}

}  // namespace weft
