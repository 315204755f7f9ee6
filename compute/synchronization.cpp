// Chooses between the two forms of a barrier and of a submit. See synchronization.h.
#include "compute/synchronization.h"

#include <span>
#include <vector>

#include "compute/device.h"

namespace weft::compute {
namespace {

constexpr VkFlags64 kOld = 0xffffffff;   // these bits mean the same in both forms

struct Finer {
  VkFlags64 bits;
  VkFlags old;
};

constexpr Finer kFinerStages[] = {
    {VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_RESOLVE_BIT | VK_PIPELINE_STAGE_2_BLIT_BIT | VK_PIPELINE_STAGE_2_CLEAR_BIT,
     VK_PIPELINE_STAGE_TRANSFER_BIT},
    {VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, VK_PIPELINE_STAGE_VERTEX_INPUT_BIT},
    {VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT, VK_PIPELINE_STAGE_VERTEX_SHADER_BIT},
};

constexpr Finer kFinerAccesses[] = {
    {VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT, VK_ACCESS_SHADER_READ_BIT},
    {VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, VK_ACCESS_SHADER_WRITE_BIT},
};

VkFlags coarser(std::span<const Finer> table, VkFlags64 bits) {
  VkFlags old = static_cast<VkFlags>(bits & kOld);
  for (const Finer& finer : table)
    if (bits & finer.bits) old |= finer.old;
  return old;
}

}  // namespace

VkPipelineStageFlags coarser_stages(VkPipelineStageFlags2 stages, const Features& features) {
  VkPipelineStageFlags old = coarser(kFinerStages, stages);
  if ((stages & VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT) == 0) return old;
  if (features.tessellation_shader)
    old |= VK_PIPELINE_STAGE_TESSELLATION_CONTROL_SHADER_BIT | VK_PIPELINE_STAGE_TESSELLATION_EVALUATION_SHADER_BIT;
  if (features.geometry_shader) old |= VK_PIPELINE_STAGE_GEOMETRY_SHADER_BIT;
  if (features.task_shader) old |= VK_PIPELINE_STAGE_TASK_SHADER_BIT_EXT;
  if (features.mesh_shader) old |= VK_PIPELINE_STAGE_MESH_SHADER_BIT_EXT;
  return old;
}

VkAccessFlags coarser_accesses(VkAccessFlags2 accesses) { return coarser(kFinerAccesses, accesses); }

void record_barrier(const Device& device, VkCommandBuffer commands, const VkMemoryBarrier2& barrier) {
  if (device.features().synchronization2) {
    auto dependency = typed<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    device.vk().vkCmdPipelineBarrier2(commands, &dependency);
    return;
  }
  auto memory = typed<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  memory.srcAccessMask = coarser_accesses(barrier.srcAccessMask);
  memory.dstAccessMask = coarser_accesses(barrier.dstAccessMask);
  device.vk().vkCmdPipelineBarrier(commands, coarser_stages(barrier.srcStageMask, device.features()),
                                   coarser_stages(barrier.dstStageMask, device.features()), 0, 1, &memory, 0, nullptr, 0, nullptr);
}

VkResult submit_to(const Functions& fn, const Features& features, VkQueue queue, const VkSubmitInfo2& work, VkFence fence) {
  if (features.synchronization2) return fn.vkQueueSubmit2(queue, 1, &work, fence);
  const std::span waits(work.pWaitSemaphoreInfos, work.waitSemaphoreInfoCount);
  const std::span signals(work.pSignalSemaphoreInfos, work.signalSemaphoreInfoCount);
  std::vector<VkSemaphore> waited, signalled;
  std::vector<VkPipelineStageFlags> stages;
  std::vector<uint64_t> wait_values, signal_values;   // those of binary semaphores are ignored
  std::vector<VkCommandBuffer> commands;
  for (const VkSemaphoreSubmitInfo& wait : waits) {
    waited.push_back(wait.semaphore);
    wait_values.push_back(wait.value);
    const VkPipelineStageFlags old = coarser_stages(wait.stageMask, features);
    stages.push_back(old != 0 ? old : VkPipelineStageFlags{VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT});   // no stage: nothing waits
  }
  for (const VkSemaphoreSubmitInfo& signal : signals) {
    signalled.push_back(signal.semaphore);
    signal_values.push_back(signal.value);
  }
  for (const VkCommandBufferSubmitInfo& buffer : std::span(work.pCommandBufferInfos, work.commandBufferInfoCount))
    commands.push_back(buffer.commandBuffer);
  auto values = typed<VkTimelineSemaphoreSubmitInfo>(VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO);
  values.waitSemaphoreValueCount = work.waitSemaphoreInfoCount;
  values.pWaitSemaphoreValues = wait_values.data();
  values.signalSemaphoreValueCount = work.signalSemaphoreInfoCount;
  values.pSignalSemaphoreValues = signal_values.data();
  auto old = typed<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  if (features.timeline_semaphore) old.pNext = &values;
  old.waitSemaphoreCount = work.waitSemaphoreInfoCount;
  old.pWaitSemaphores = waited.data();
  old.pWaitDstStageMask = stages.data();
  old.commandBufferCount = work.commandBufferInfoCount;
  old.pCommandBuffers = commands.data();
  old.signalSemaphoreCount = work.signalSemaphoreInfoCount;
  old.pSignalSemaphores = signalled.data();
  return fn.vkQueueSubmit(queue, 1, &old, fence);
}

}  // namespace weft::compute
