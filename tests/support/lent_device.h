// A host's own Vulkan device, made with the features that a test wants, and lent to Weft with the word of what it was made with.
#pragma once

#include <memory>
#include <vector>

#include "tests/support/must.h"
#include "tests/support/on_device.h"

namespace weft {

/// Destroyed before the instance that it is of.
class LentDevice {
 public:
  struct Host {
    const compute::Functions& vk;   // those of its instance
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    uint32_t queue_family = 0;
  };

  /// `enabled`: the chain of VkDeviceCreateInfo. `function`: what Weft gets as vkGetInstanceProcAddr; null: the instance's own.
  LentDevice(const Host& host, const void* enabled, const VkPhysicalDeviceFeatures& core = {},
             const std::vector<const char*>& extensions = {}, PFN_vkGetInstanceProcAddr function = nullptr) {
    const float priority = 1;
    auto queue = compute::typed<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
    queue.queueFamilyIndex = host.queue_family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    auto create = compute::typed<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
    create.pNext = enabled;
    create.queueCreateInfoCount = 1;
    create.pQueueCreateInfos = &queue;
    create.pEnabledFeatures = &core;
    create.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    create.ppEnabledExtensionNames = extensions.data();
    if (host.vk.vkCreateDevice(host.physical, &create, nullptr, &device_) != VK_SUCCESS) throw std::runtime_error("no second device");
    const auto get = reinterpret_cast<PFN_vkGetDeviceQueue>(host.vk.vkGetDeviceProcAddr(device_, "vkGetDeviceQueue"));
    destroy_ = reinterpret_cast<PFN_vkDestroyDevice>(host.vk.vkGetDeviceProcAddr(device_, "vkDestroyDevice"));
    VkQueue first = VK_NULL_HANDLE;
    get(device_, host.queue_family, 0, &first);
    lent_ = must(compute::Device::borrow({function != nullptr ? function : host.vk.vkGetInstanceProcAddr, host.instance, host.physical,
                                          device_, first, host.queue_family, &create}));
  }
  /// Of another's instance, with synchronization2 and timeline semaphores besides what `v12` and `core` want.
  explicit LentDevice(const compute::Device& of, VkPhysicalDeviceVulkan12Features v12 = {}, const VkPhysicalDeviceFeatures& core = {})
      : LentDevice({of.vk(), of.instance(), of.physical(), of.queue_family()}, chained(v12), core) {}
  ~LentDevice() {
    lent_.reset();
    if (device_ != VK_NULL_HANDLE) destroy_(device_, nullptr);
  }
  LentDevice(const LentDevice&) = delete;
  LentDevice& operator=(const LentDevice&) = delete;
  const compute::Device& operator*() const { return *lent_; }

 private:
  const void* chained(VkPhysicalDeviceVulkan12Features& v12) {
    v13_.synchronization2 = VK_TRUE;
    v12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    v12.pNext = &v13_;
    v12.timelineSemaphore = VK_TRUE;
    return &v12;
  }

  VkPhysicalDeviceVulkan13Features v13_ =
      compute::typed<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  VkDevice device_ = VK_NULL_HANDLE;
  PFN_vkDestroyDevice destroy_ = nullptr;
  std::unique_ptr<compute::Device> lent_;
};

}  // namespace weft
