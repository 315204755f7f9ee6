// Command buffers outside the frame: record, submit, wait.
#pragma once

#include <functional>
#include <string_view>

#include "compute/owned.h"

namespace weft::compute {

/// A pool and the command buffers taken from it; not thread-safe, like the pool it is.
class CommandPool {
 public:
  /// Buffers can be reset one by one.
  static Result<CommandPool> create(const Device& device, std::string_view name);
  CommandPool() = default;
  /// Freed with the pool.
  Result<VkCommandBuffer> allocate(std::string_view name) const;

 private:
  const Device* device_ = nullptr;
  OwnedCommandPool pool_;
};

Result<OwnedFence> create_fence(const Device& device, std::string_view name, bool signalled = false);
/// One that the device sets and the host asks for and resets.
Result<OwnedEvent> create_event(const Device& device, std::string_view name);
/// Takes the feature timelineSemaphore (Device::features).
Result<OwnedSemaphore> create_timeline(const Device& device, std::string_view name, uint64_t value = 0);
/// For a swapchain.
Result<OwnedSemaphore> create_binary_semaphore(const Device& device, std::string_view name);

/// Waits at most `seconds`; running out of time is an error, as a lost device is. GPUs lose a device that hangs within
/// seconds; the limit is for software drivers, on which a large frame may take minutes.
Result<void> wait_for(const Device& device, VkFence fence, double seconds = 600);
Result<void> wait_for(const Device& device, VkSemaphore timeline, uint64_t value, double seconds = 600);

/// Records once, submits, waits. For set-up and tests, not for a frame. What was written before by submits to this queue
/// is visible to `record`, and what it writes is visible to the host and to everything that is submitted later.
Result<void> run_once(const Device& device, std::string_view name, const std::function<void(VkCommandBuffer)>& record);

}  // namespace weft::compute
