// See samples/host_engine/frames.h.
#include "samples/host_engine/frames.h"

namespace host {

Result<std::unique_ptr<Frames>> Frames::create(const Device& device) {
  std::unique_ptr<Frames> made(new Frames(device));
  auto pool = typed<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = device.queue_family();
  if (auto done = checked(vkCreateCommandPool(device.handle(), &pool, nullptr, &made->pool_), "vkCreateCommandPool"); !done)
    return done.take_error();
  auto allocate = typed<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = made->pool_;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = static_cast<std::uint32_t>(made->commands_.size());
  if (auto done = checked(vkAllocateCommandBuffers(device.handle(), &allocate, made->commands_.data()), "vkAllocateCommandBuffers"); !done)
    return done.take_error();
  auto type = typed<VkSemaphoreTypeCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO);
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  auto semaphore = typed<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
  semaphore.pNext = &type;
  if (auto done = checked(vkCreateSemaphore(device.handle(), &semaphore, nullptr, &made->drawn_), "vkCreateSemaphore"); !done)
    return done.take_error();
  return made;
}

Frames::~Frames() {
  if (drawn_ != VK_NULL_HANDLE) (void)wait();   // an error says that the device is lost; nothing can be done
  vkDeviceWaitIdle(device_->handle());          // the software driver (Mesa 22.3) looks at semaphores for a moment after they are signalled
  vkDestroySemaphore(device_->handle(), drawn_, nullptr);
  vkDestroyCommandPool(device_->handle(), pool_, nullptr);
}

Result<VkCommandBuffer> Frames::begin() {
  if (submitted_ >= commands_.size())
    if (auto done = wait_for(submitted_ + 1 - commands_.size()); !done) return done.take_error();
  const VkCommandBuffer commands = commands_[submitted_ % commands_.size()];
  auto begin = typed<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  if (auto done = checked(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer"); !done) return done.take_error();
  return commands;
}

Result<void> Frames::end(std::span<const VkSemaphoreSubmitInfo> waits) {
  const VkCommandBuffer commands = commands_[submitted_ % commands_.size()];
  if (auto done = checked(vkEndCommandBuffer(commands), "vkEndCommandBuffer"); !done) return done;
  auto buffer = typed<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
  buffer.commandBuffer = commands;
  VkSemaphoreSubmitInfo signal = drawn();
  ++signal.value;
  auto work = typed<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
  work.waitSemaphoreInfoCount = static_cast<std::uint32_t>(waits.size());
  work.pWaitSemaphoreInfos = waits.data();
  work.commandBufferInfoCount = 1;
  work.pCommandBufferInfos = &buffer;
  work.signalSemaphoreInfoCount = 1;
  work.pSignalSemaphoreInfos = &signal;
  auto done = device_->submit(work);
  if (done) ++submitted_;
  return done;
}

VkSemaphoreSubmitInfo Frames::drawn() const {
  auto info = typed<VkSemaphoreSubmitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO);
  info.semaphore = drawn_;
  info.value = submitted_;
  info.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  return info;
}

Result<void> Frames::wait() const { return wait_for(submitted_); }

Result<void> Frames::wait_for(std::uint64_t value) const {
  constexpr std::uint64_t kLongest = 60'000'000'000;   // ns
  auto wait = typed<VkSemaphoreWaitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO);
  wait.semaphoreCount = 1;
  wait.pSemaphores = &drawn_;
  wait.pValues = &value;
  return checked(vkWaitSemaphores(device_->handle(), &wait, kLongest), "waiting at most 60 s for a frame");
}

}  // namespace host
