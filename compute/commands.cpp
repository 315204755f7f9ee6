// Command pools, fences and semaphores. See commands.h.
#include "compute/commands.h"

#include "compute/synchronization.h"

namespace weft::compute {
namespace {

Result<OwnedSemaphore> create_semaphore(const Device& device, std::string_view name, VkSemaphoreType type,
                                        uint64_t value) {
  auto kind = typed<VkSemaphoreTypeCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO);
  kind.semaphoreType = type;
  kind.initialValue = value;
  auto create = typed<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
  create.pNext = &kind;
  VkSemaphore semaphore = VK_NULL_HANDLE;
  const VkResult result = device.vk().vkCreateSemaphore(device.handle(), &create, nullptr, &semaphore);
  if (result != VK_SUCCESS) return fail("semaphore ", name, " could not be created: ", result_name(result));
  device.name_object(VK_OBJECT_TYPE_SEMAPHORE, semaphore, name);
  return OwnedSemaphore(device, semaphore);
}

/// 64 bits of nanoseconds end after 584 years; anything near that is for ever.
uint64_t nanoseconds(double seconds) { return seconds < 1e10 ? static_cast<uint64_t>(seconds * 1e9) : UINT64_MAX; }

/// Who is told that waiting failed must think that nothing has happened. Where there was no memory to wait with, there may be some now.
template <class Wait>
Result<void> waited(const Device& device, double seconds, Wait&& wait) {
  VkResult result = wait(nanoseconds(seconds));
  if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY) result = wait(nanoseconds(seconds));
  if (device.heard(result) == VK_SUCCESS) return {};
  if (result == VK_TIMEOUT) return fail(ErrorKind::other, device.name(), " did not finish its work within ", seconds, " s");
  return fail("waiting for ", device.name(), " failed: ", result_name(result));
}

/// Everything before is finished and visible to everything after, the host included.
void full_barrier(const Device& device, VkCommandBuffer commands) {
  auto barrier = typed<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_HOST_READ_BIT;
  record_barrier(device, commands, barrier);
}

}  // namespace

Result<CommandPool> CommandPool::create(const Device& device, std::string_view name) {
  auto create = typed<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  create.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  create.queueFamilyIndex = device.queue_family();
  VkCommandPool pool = VK_NULL_HANDLE;
  const VkResult result = device.vk().vkCreateCommandPool(device.handle(), &create, nullptr, &pool);
  if (result != VK_SUCCESS) return fail("command pool ", name, " could not be created: ", result_name(result));
  device.name_object(VK_OBJECT_TYPE_COMMAND_POOL, pool, name);
  CommandPool made;
  made.device_ = &device;
  made.pool_ = OwnedCommandPool(device, pool);
  return made;
}

Result<VkCommandBuffer> CommandPool::allocate(std::string_view name) const {
  auto allocate = typed<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = pool_.get();
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  const VkResult result = device_->vk().vkAllocateCommandBuffers(device_->handle(), &allocate, &commands);
  if (result != VK_SUCCESS) return fail("command buffer ", name, " could not be allocated: ", result_name(result));
  device_->name_object(VK_OBJECT_TYPE_COMMAND_BUFFER, commands, name);
  return commands;
}

Result<OwnedEvent> create_event(const Device& device, std::string_view name) {
  const auto create = typed<VkEventCreateInfo>(VK_STRUCTURE_TYPE_EVENT_CREATE_INFO);
  VkEvent event = VK_NULL_HANDLE;
  const VkResult result = device.vk().vkCreateEvent(device.handle(), &create, nullptr, &event);
  if (result != VK_SUCCESS) return fail("event ", name, " could not be created: ", result_name(result));
  device.name_object(VK_OBJECT_TYPE_EVENT, event, name);
  return OwnedEvent(device, event);
}

Result<OwnedFence> create_fence(const Device& device, std::string_view name, bool signalled) {
  auto create = typed<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  create.flags = signalled ? VK_FENCE_CREATE_SIGNALED_BIT : 0;
  VkFence fence = VK_NULL_HANDLE;
  const VkResult result = device.vk().vkCreateFence(device.handle(), &create, nullptr, &fence);
  if (result != VK_SUCCESS) return fail("fence ", name, " could not be created: ", result_name(result));
  device.name_object(VK_OBJECT_TYPE_FENCE, fence, name);
  return OwnedFence(device, fence);
}

Result<OwnedSemaphore> create_timeline(const Device& device, std::string_view name, uint64_t value) {
  return create_semaphore(device, name, VK_SEMAPHORE_TYPE_TIMELINE, value);
}

Result<OwnedSemaphore> create_binary_semaphore(const Device& device, std::string_view name) {
  return create_semaphore(device, name, VK_SEMAPHORE_TYPE_BINARY, 0);
}

Result<void> wait_for(const Device& device, VkFence fence, double seconds) {
  return waited(device, seconds, [&](uint64_t most) { return device.vk().vkWaitForFences(device.handle(), 1, &fence, VK_TRUE, most); });
}

Result<void> wait_for(const Device& device, VkSemaphore timeline, uint64_t value, double seconds) {
  auto wait = typed<VkSemaphoreWaitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO);
  wait.semaphoreCount = 1;
  wait.pSemaphores = &timeline;
  wait.pValues = &value;
  return waited(device, seconds, [&](uint64_t most) { return device.vk().vkWaitSemaphores(device.handle(), &wait, most); });
}

Result<void> run_once(const Device& device, std::string_view name, const std::function<void(VkCommandBuffer)>& record) {
  const Functions& fn = device.vk();
  Result<CommandPool> pool = CommandPool::create(device, name);
  if (!pool) return pool.take_error();
  Result<VkCommandBuffer> commands = pool->allocate(name);
  if (!commands) return commands.take_error();
  Result<OwnedFence> fence = create_fence(device, name);
  if (!fence) return fence.take_error();
  auto begin = typed<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  VkResult result = fn.vkBeginCommandBuffer(*commands, &begin);
  if (result == VK_SUCCESS) {
    full_barrier(device, *commands);
    record(*commands);
    full_barrier(device, *commands);
    result = fn.vkEndCommandBuffer(*commands);
  }
  if (result != VK_SUCCESS) return fail("command buffer ", name, " could not be recorded: ", result_name(result));
  auto commanded = typed<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
  commanded.commandBuffer = *commands;
  auto work = typed<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
  work.commandBufferInfoCount = 1;
  work.pCommandBufferInfos = &commanded;
  if (Result<void> submitted = device.submit(work, fence->get()); !submitted) return submitted;
  Result<void> waited = wait_for(device, fence->get());
  if (waited) return waited;
  // The pool must not be freed while its commands run: wait for them without a limit, and report success if they end. On a lost
  // device this returns at once.
  const VkFence handle = fence->get();
  return fn.vkWaitForFences(device.handle(), 1, &handle, VK_TRUE, UINT64_MAX) == VK_SUCCESS ? Result<void>() : waited;
}

}  // namespace weft::compute
