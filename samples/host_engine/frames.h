// Two frames under way: while the GPU draws one, the CPU records the next.
//
// A timeline semaphore counts the frames that are drawn. It is what the CPU waits for before it reuses a command buffer,
// and what Weft's next frame waits for before it overwrites the vertices that a draw still reads.
#pragma once

#include <array>
#include <span>

#include "samples/host_engine/device.h"

namespace host {

class Frames {
 public:
  static Result<std::unique_ptr<Frames>> create(const Device& device);
  ~Frames();
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;

  /// A command buffer that is being recorded; waits until the frame before the last one is drawn.
  Result<VkCommandBuffer> begin();
  /// Ends and submits it: on the GPU it starts after `waits`.
  Result<void> end(std::span<const VkSemaphoreSubmitInfo> waits = {});

  /// What to wait for on the GPU until all frames so far are drawn.
  VkSemaphoreSubmitInfo drawn() const;
  /// Waits for that on the CPU.
  Result<void> wait() const;

 private:
  explicit Frames(const Device& device) : device_(&device) {}
  Result<void> wait_for(std::uint64_t value) const;

  const Device* device_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::array<VkCommandBuffer, 2> commands_{};
  VkSemaphore drawn_ = VK_NULL_HANDLE;
  std::uint64_t submitted_ = 0;   // frames; the semaphore's value when the last one is drawn
};

}  // namespace host
