// A host's own Vulkan device, made with the features that a test wants beside Weft's four, and lent to Weft with the word of what it was
// made with.
#pragma once

#include <memory>

#include "tests/support/must.h"
#include "tests/support/on_device.h"

namespace weft {

/// Destroyed before the device whose instance it is of.
class LentDevice {
 public:
  explicit LentDevice(const compute::Device& of, VkPhysicalDeviceVulkan12Features v12 = {}, VkPhysicalDeviceFeatures core = {}) {
    auto v13 = compute::typed<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
    v13.synchronization2 = VK_TRUE;
    v12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    v12.pNext = &v13;
    v12.timelineSemaphore = v12.hostQueryReset = v12.scalarBlockLayout = VK_TRUE;
    const float priority = 1;
    auto queue = compute::typed<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
    queue.queueFamilyIndex = of.queue_family();
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    auto create = compute::typed<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
    create.pNext = &v12;
    create.queueCreateInfoCount = 1;
    create.pQueueCreateInfos = &queue;
    create.pEnabledFeatures = &core;
    if (of.vk().vkCreateDevice(of.physical(), &create, nullptr, &device_) != VK_SUCCESS) throw std::runtime_error("no second device");
    const auto get = reinterpret_cast<PFN_vkGetDeviceQueue>(function("vkGetDeviceQueue", of));
    VkQueue first = VK_NULL_HANDLE;
    get(device_, of.queue_family(), 0, &first);
    destroy_ = reinterpret_cast<PFN_vkDestroyDevice>(function("vkDestroyDevice", of));
    lent_ = must(compute::Device::borrow(
        {of.vk().vkGetInstanceProcAddr, of.instance(), of.physical(), device_, first, of.queue_family(), &create}));
  }
  ~LentDevice() {
    lent_.reset();
    if (device_ != VK_NULL_HANDLE) destroy_(device_, nullptr);
  }
  LentDevice(const LentDevice&) = delete;
  LentDevice& operator=(const LentDevice&) = delete;
  const compute::Device& operator*() const { return *lent_; }

 private:
  PFN_vkVoidFunction function(const char* name, const compute::Device& of) const { return of.vk().vkGetDeviceProcAddr(device_, name); }

  VkDevice device_ = VK_NULL_HANDLE;
  PFN_vkDestroyDevice destroy_ = nullptr;
  std::unique_ptr<compute::Device> lent_;
};

}  // namespace weft
