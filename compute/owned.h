// A Vulkan handle that is destroyed with its owner.
//
// The device must outlive it, and the GPU must be done with it: nobody waits here.
#pragma once

#include <utility>

#include "compute/device.h"

namespace weft::compute {

/// `Destroy` is the member of Functions that ends the handle, as in Owned<VkFence, &Functions::vkDestroyFence>.
template <class Handle, auto Destroy>
class Owned {
 public:
  Owned() = default;
  Owned(const Device& device, Handle handle) : device_(&device), handle_(handle) {}
  Owned(Owned&& other) noexcept
      : device_(std::exchange(other.device_, nullptr)), handle_(std::exchange(other.handle_, VK_NULL_HANDLE)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Owned() {
    if (handle_ != VK_NULL_HANDLE) (device_->vk().*Destroy)(device_->handle(), handle_, nullptr);
  }

  Handle get() const { return handle_; }
  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

 private:
  const Device* device_ = nullptr;
  Handle handle_ = VK_NULL_HANDLE;
};

using OwnedBuffer = Owned<VkBuffer, &Functions::vkDestroyBuffer>;
using OwnedBufferView = Owned<VkBufferView, &Functions::vkDestroyBufferView>;
using OwnedMemory = Owned<VkDeviceMemory, &Functions::vkFreeMemory>;
using OwnedFence = Owned<VkFence, &Functions::vkDestroyFence>;
using OwnedEvent = Owned<VkEvent, &Functions::vkDestroyEvent>;
using OwnedSemaphore = Owned<VkSemaphore, &Functions::vkDestroySemaphore>;
using OwnedCommandPool = Owned<VkCommandPool, &Functions::vkDestroyCommandPool>;
using OwnedQueryPool = Owned<VkQueryPool, &Functions::vkDestroyQueryPool>;
using OwnedShaderModule = Owned<VkShaderModule, &Functions::vkDestroyShaderModule>;
using OwnedPipeline = Owned<VkPipeline, &Functions::vkDestroyPipeline>;
using OwnedPipelineLayout = Owned<VkPipelineLayout, &Functions::vkDestroyPipelineLayout>;
using OwnedPipelineCache = Owned<VkPipelineCache, &Functions::vkDestroyPipelineCache>;
using OwnedSetLayout = Owned<VkDescriptorSetLayout, &Functions::vkDestroyDescriptorSetLayout>;
using OwnedDescriptorPool = Owned<VkDescriptorPool, &Functions::vkDestroyDescriptorPool>;
using OwnedImage = Owned<VkImage, &Functions::vkDestroyImage>;
using OwnedImageView = Owned<VkImageView, &Functions::vkDestroyImageView>;
using OwnedSampler = Owned<VkSampler, &Functions::vkDestroySampler>;

}  // namespace weft::compute
