// Vulkan with an ear on which bytes every command touches: what goes through here becomes a stream for hazards.h, in the order of
// submission. A shader's accesses are read from its SPIR-V, buffers from the descriptor sets as they are when a dispatch is recorded.
//
// With `computes` off pipelines are neither compiled nor dispatched: everything else goes on, and the commands are the same as long as
// the host does not look at what was computed. Vulkan's functions carry no user pointer, hence the variable; one thread.
#pragma once

#include <cstring>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "compute/functions.h"
#include "compute/reflect.h"
#include "tests/support/hazards.h"

namespace weft::overheard {

#define WEFT_HEARD_FUNCTIONS(X) \
  X(vkCreateBuffer) X(vkAllocateMemory) X(vkMapMemory) X(vkBindBufferMemory) X(vkCreateBufferView) \
  X(vkCreateShaderModule) X(vkDestroyShaderModule) X(vkCreateComputePipelines) X(vkDestroyPipeline) \
  X(vkUpdateDescriptorSets) X(vkBeginCommandBuffer) X(vkCmdBindPipeline) X(vkCmdBindDescriptorSets) \
  X(vkCmdPushConstants) X(vkCmdDispatch) X(vkCmdDispatchIndirect) X(vkCmdPipelineBarrier2) X(vkCmdPipelineBarrier) \
  X(vkCmdCopyBuffer) X(vkCmdFillBuffer) X(vkCmdUpdateBuffer) X(vkQueueSubmit2) X(vkQueueSubmit) X(vkWaitForFences) X(vkWaitSemaphores) \
  X(vkSetDebugUtilsObjectNameEXT)

enum class Call {
#define WEFT_CALL(name) name,
  WEFT_HEARD_FUNCTIONS(WEFT_CALL)
#undef WEFT_CALL
};
template <Call kCall>
struct Tag {};

using hazards::Access;
using hazards::Event;
using hazards::Stages;

struct Ear {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;   // the real one
  PFN_vkGetDeviceProcAddr get_device_proc_addr = nullptr;
  bool computes = true;
  long submits_left = -1;                                       // that find memory; -1: all
  hazards::Stream stream;

  /// What the host does with a buffer in its own commands: a draw.
  void touches(VkCommandBuffer into, const char* name, VkBuffer buffer, Stages stage, VkAccessFlags2 access) {
    add(into, Event::Kind::command, name, {part(buffer, 0, VK_WHOLE_SIZE, stage, access)});
  }
  /// Forgets the stream and all that has gone; what is alive must not be used any more.
  void begin() {
    Ear deaf;
    deaf.get_instance_proc_addr = get_instance_proc_addr;
    deaf.get_device_proc_addr = get_device_proc_addr;
    *this = std::move(deaf);
  }

  struct Bytes {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset = 0, bytes = 0;
  };
  struct Buffer {
    std::uint32_t number = 0;   // in the stream
    VkDeviceSize bytes = 0;
  };
  struct Pipeline {
    std::string name;
    std::vector<compute::Binding> bindings;
  };
  struct Recording {
    std::string name;
    std::vector<Event> events;
    VkPipeline pipeline = VK_NULL_HANDLE;
    std::map<std::uint32_t, VkDescriptorSet> sets;
  };
  std::map<VkBuffer, Buffer> buffers;
  std::set<VkDeviceMemory> mapped;
  std::map<VkBufferView, Bytes> views;
  std::map<VkShaderModule, std::vector<compute::Binding>> modules;
  std::map<VkPipeline, Pipeline> pipelines;
  std::map<VkDescriptorSet, std::map<std::uint32_t, Bytes>> sets;
  std::map<VkCommandBuffer, Recording> recordings;
  std::map<VkFence, std::uint64_t> fences;         // submits so far, at the last one of each
  std::uint64_t submits = 0, made_up = 0;          // handles that stand for what was not made

  Access part(VkBuffer buffer, VkDeviceSize offset, VkDeviceSize bytes, Stages stage, VkAccessFlags2 access) const {
    const Buffer& whole = buffers.at(buffer);
    return {whole.number, offset, bytes == VK_WHOLE_SIZE ? whole.bytes : offset + bytes, stage, access};
  }
  Event& add(VkCommandBuffer into, Event::Kind kind, std::string name, std::vector<Access> accesses = {}) {
    Recording& recording = recordings[into];
    Event& event = recording.events.emplace_back();
    event.kind = kind;
    event.name = std::move(name);
    event.commands = recording.name;
    event.accesses = std::move(accesses);
    return event;
  }
  void dispatch(VkCommandBuffer into, std::vector<Access> accesses) {
    const Recording& recording = recordings[into];
    const Pipeline& pipeline = pipelines.at(recording.pipeline);
    for (const compute::Binding& binding : pipeline.bindings) {
      const Bytes& bytes = sets.at(recording.sets.at(binding.set)).at(binding.binding);
      using Kind = compute::Binding::Kind;
      const bool stored = binding.kind == Kind::storage_buffer || binding.kind == Kind::storage_texel_buffer;
      const VkAccessFlags2 read = stored                                  ? VK_ACCESS_2_SHADER_STORAGE_READ_BIT
                                  : binding.kind == Kind::uniform_buffer ? VK_ACCESS_2_UNIFORM_READ_BIT
                                                                         : VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
      const auto access = [&](VkAccessFlags2 how) {
        accesses.push_back(part(bytes.buffer, bytes.offset, bytes.bytes, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, how));
      };
      if (binding.read) access(read);
      if (binding.written) access(VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    }
    add(into, Event::Kind::command, pipeline.name, std::move(accesses));
  }
  void synchronise(Event::Kind kind, std::uint64_t semaphore, std::uint64_t value, Stages stages = 0) {
    Event& event = stream.events.emplace_back();
    event.kind = kind;
    event.semaphore = semaphore;
    event.value = value;
    event.stages = stages;
    event.commands = "the host";
  }
};
inline Ear ear;

template <class Handle>
std::uint64_t number_of(Handle handle) {
  return reinterpret_cast<std::uint64_t>(handle);
}

// What is heard of a call that has succeeded.

inline void heard(Tag<Call::vkCreateBuffer>, VkDevice, const VkBufferCreateInfo* create, const VkAllocationCallbacks*, VkBuffer* made) {
  const auto number = static_cast<std::uint32_t>(ear.stream.buffers.size());
  ear.buffers[*made] = {number, create->size};
  ear.stream.buffers.push_back({"buffer " + std::to_string(number)});
}
inline void heard(Tag<Call::vkAllocateMemory>, VkDevice, const VkMemoryAllocateInfo*, const VkAllocationCallbacks*, VkDeviceMemory* made) {
  ear.mapped.erase(*made);
}
inline void heard(Tag<Call::vkMapMemory>, VkDevice, VkDeviceMemory memory, VkDeviceSize, VkDeviceSize, VkMemoryMapFlags, void**) {
  ear.mapped.insert(memory);
}
inline void heard(Tag<Call::vkBindBufferMemory>, VkDevice, VkBuffer buffer, VkDeviceMemory memory, VkDeviceSize) {
  ear.stream.buffers[ear.buffers.at(buffer).number].mapped = ear.mapped.contains(memory);
}
inline void heard(Tag<Call::vkCreateBufferView>, VkDevice, const VkBufferViewCreateInfo* create, const VkAllocationCallbacks*,
                  VkBufferView* made) {
  ear.views[*made] = {create->buffer, create->offset, create->range};
}
inline void heard(Tag<Call::vkCreateShaderModule>, VkDevice, const VkShaderModuleCreateInfo* create, const VkAllocationCallbacks*,
                  VkShaderModule* made) {
  auto reflected = compute::reflect({create->pCode, create->codeSize / sizeof(std::uint32_t)});
  if (!reflected) throw std::runtime_error(reflected.error());   // nothing could be said of what it touches
  ear.modules[*made] = std::move(reflected->bindings);
}
inline void heard(Tag<Call::vkCreateComputePipelines>, VkDevice, VkPipelineCache, std::uint32_t count,
                  const VkComputePipelineCreateInfo* create, const VkAllocationCallbacks*, VkPipeline* made) {
  for (std::uint32_t k = 0; k < count; ++k) ear.pipelines[made[k]] = {"", ear.modules.at(create[k].stage.module)};
}
inline void heard(Tag<Call::vkSetDebugUtilsObjectNameEXT>, VkDevice, const VkDebugUtilsObjectNameInfoEXT* named) {
  const auto is = [&](auto handle) { return number_of(handle) == named->objectHandle; };
  if (named->objectType == VK_OBJECT_TYPE_BUFFER)
    for (const auto& [handle, buffer] : ear.buffers)
      if (is(handle)) ear.stream.buffers[buffer.number].name = named->pObjectName;
  if (named->objectType == VK_OBJECT_TYPE_PIPELINE)
    for (auto& [handle, pipeline] : ear.pipelines)
      if (is(handle)) pipeline.name = named->pObjectName;
  if (named->objectType == VK_OBJECT_TYPE_COMMAND_BUFFER)
    ear.recordings[reinterpret_cast<VkCommandBuffer>(named->objectHandle)].name = named->pObjectName;
}
inline void heard(Tag<Call::vkUpdateDescriptorSets>, VkDevice, std::uint32_t count, const VkWriteDescriptorSet* writes, std::uint32_t,
                  const VkCopyDescriptorSet*) {
  for (const VkWriteDescriptorSet& write : std::span(writes, count)) {
    const bool texels = write.descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER ||
                        write.descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
    for (std::uint32_t k = 0; k < write.descriptorCount; ++k)
      ear.sets[write.dstSet][write.dstBinding + k] =
          texels ? ear.views.at(write.pTexelBufferView[k])
                 : Ear::Bytes{write.pBufferInfo[k].buffer, write.pBufferInfo[k].offset, write.pBufferInfo[k].range};
  }
}
inline void heard(Tag<Call::vkBeginCommandBuffer>, VkCommandBuffer commands, const VkCommandBufferBeginInfo*) {
  ear.recordings[commands].events.clear();
  ear.recordings[commands].sets.clear();
}
inline void heard(Tag<Call::vkCmdBindPipeline>, VkCommandBuffer commands, VkPipelineBindPoint, VkPipeline pipeline) {
  ear.recordings[commands].pipeline = pipeline;
}
inline void heard(Tag<Call::vkCmdBindDescriptorSets>, VkCommandBuffer commands, VkPipelineBindPoint, VkPipelineLayout, std::uint32_t first,
                  std::uint32_t count, const VkDescriptorSet* sets, std::uint32_t, const std::uint32_t*) {
  for (std::uint32_t k = 0; k < count; ++k) ear.recordings[commands].sets[first + k] = sets[k];
}
inline void heard(Tag<Call::vkCmdDispatch>, VkCommandBuffer commands, std::uint32_t, std::uint32_t, std::uint32_t) {
  ear.dispatch(commands, {});
}
inline void heard(Tag<Call::vkCmdDispatchIndirect>, VkCommandBuffer commands, VkBuffer arguments, VkDeviceSize offset) {
  ear.dispatch(commands, {ear.part(arguments, offset, sizeof(VkDispatchIndirectCommand), VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                                   VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT)});
}
// Barriers of single buffers and of images count for nothing: Weft's frames have none.
inline void heard(Tag<Call::vkCmdPipelineBarrier2>, VkCommandBuffer commands, const VkDependencyInfo* dependency) {
  for (std::uint32_t k = 0; k < dependency->memoryBarrierCount; ++k)
    ear.add(commands, Event::Kind::barrier, "barrier").barrier = dependency->pMemoryBarriers[k];
}
// Its bits mean the same.
inline void heard(Tag<Call::vkCmdPipelineBarrier>, VkCommandBuffer commands, VkPipelineStageFlags from, VkPipelineStageFlags to,
                  VkDependencyFlags, std::uint32_t count, const VkMemoryBarrier* barriers, std::uint32_t, const VkBufferMemoryBarrier*,
                  std::uint32_t, const VkImageMemoryBarrier*) {
  for (const VkMemoryBarrier& barrier : std::span(barriers, count)) {
    VkMemoryBarrier2& told = ear.add(commands, Event::Kind::barrier, "barrier").barrier;
    told.srcStageMask = from;
    told.srcAccessMask = barrier.srcAccessMask;
    told.dstStageMask = to;
    told.dstAccessMask = barrier.dstAccessMask;
  }
}
inline void heard(Tag<Call::vkCmdCopyBuffer>, VkCommandBuffer commands, VkBuffer from, VkBuffer to, std::uint32_t count,
                  const VkBufferCopy* regions) {
  std::vector<Access> accesses;
  for (const VkBufferCopy& region : std::span(regions, count)) {
    accesses.push_back(ear.part(from, region.srcOffset, region.size, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT));
    accesses.push_back(ear.part(to, region.dstOffset, region.size, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT));
  }
  ear.add(commands, Event::Kind::command, "copy", std::move(accesses));
}
inline void heard(Tag<Call::vkCmdFillBuffer>, VkCommandBuffer commands, VkBuffer to, VkDeviceSize offset, VkDeviceSize bytes,
                  std::uint32_t) {
  ear.add(commands, Event::Kind::command, "fill",
          {ear.part(to, offset, bytes, VK_PIPELINE_STAGE_2_CLEAR_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT)});
}
inline void heard(Tag<Call::vkCmdUpdateBuffer>, VkCommandBuffer commands, VkBuffer to, VkDeviceSize offset, VkDeviceSize bytes,
                  const void*) {
  ear.add(commands, Event::Kind::command, "update",
          {ear.part(to, offset, bytes, VK_PIPELINE_STAGE_2_CLEAR_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT)});
}
inline void heard_commands(VkCommandBuffer commands) {
  const std::vector<Event>& events = ear.recordings.at(commands).events;
  ear.stream.events.insert(ear.stream.events.end(), events.begin(), events.end());
}
inline void heard_fence(VkFence fence) {
  ear.fences[fence] = ++ear.submits;
  if (fence != VK_NULL_HANDLE)
    ear.synchronise(Event::Kind::signal, number_of(fence), ear.submits, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
}
inline void heard(Tag<Call::vkQueueSubmit2>, VkQueue, std::uint32_t count, const VkSubmitInfo2* works, VkFence fence) {
  for (const VkSubmitInfo2& work : std::span(works, count)) {
    for (const VkSemaphoreSubmitInfo& wait : std::span(work.pWaitSemaphoreInfos, work.waitSemaphoreInfoCount))
      ear.synchronise(Event::Kind::wait, number_of(wait.semaphore), wait.value, wait.stageMask);
    for (const VkCommandBufferSubmitInfo& commands : std::span(work.pCommandBufferInfos, work.commandBufferInfoCount))
      heard_commands(commands.commandBuffer);
    for (const VkSemaphoreSubmitInfo& signal : std::span(work.pSignalSemaphoreInfos, work.signalSemaphoreInfoCount))
      ear.synchronise(Event::Kind::signal, number_of(signal.semaphore), signal.value, signal.stageMask);
  }
  heard_fence(fence);
}
// Of a device without timeline semaphores: fences alone.
inline void heard(Tag<Call::vkQueueSubmit>, VkQueue, std::uint32_t count, const VkSubmitInfo* works, VkFence fence) {
  for (const VkSubmitInfo& work : std::span(works, count)) {
    if (work.waitSemaphoreCount + work.signalSemaphoreCount > 0) throw std::runtime_error("semaphores of vkQueueSubmit are not heard");
    for (const VkCommandBuffer commands : std::span(work.pCommandBuffers, work.commandBufferCount)) heard_commands(commands);
  }
  heard_fence(fence);
}
inline void heard(Tag<Call::vkWaitForFences>, VkDevice, std::uint32_t count, const VkFence* fences, VkBool32, std::uint64_t) {
  for (const VkFence fence : std::span(fences, count)) ear.synchronise(Event::Kind::host_wait, number_of(fence), ear.fences[fence]);
}
inline void heard(Tag<Call::vkWaitSemaphores>, VkDevice, const VkSemaphoreWaitInfo* wait, std::uint64_t) {
  for (std::uint32_t k = 0; k < wait->semaphoreCount; ++k)
    ear.synchronise(Event::Kind::host_wait, number_of(wait->pSemaphores[k]), wait->pValues[k]);
}

// What does not reach the driver while nothing computes. What should be made gets a handle that stands for nothing.

template <Call kCall>
constexpr bool is_silenced() {
  return kCall == Call::vkCmdBindPipeline || kCall == Call::vkCmdBindDescriptorSets || kCall == Call::vkCmdPushConstants ||
         kCall == Call::vkCmdDispatch || kCall == Call::vkCmdDispatchIndirect || kCall == Call::vkDestroyPipeline ||
         kCall == Call::vkDestroyShaderModule;
}
inline bool makes_up(Tag<Call::vkCreateShaderModule>, VkDevice, const VkShaderModuleCreateInfo*, const VkAllocationCallbacks*,
                     VkShaderModule* made) {
  *made = reinterpret_cast<VkShaderModule>(++ear.made_up);
  return true;
}
inline bool makes_up(Tag<Call::vkCreateComputePipelines>, VkDevice, VkPipelineCache, std::uint32_t count,
                     const VkComputePipelineCreateInfo*, const VkAllocationCallbacks*, VkPipeline* made) {
  for (std::uint32_t k = 0; k < count; ++k) made[k] = reinterpret_cast<VkPipeline>(++ear.made_up);
  return true;
}
inline bool makes_up(Tag<Call::vkSetDebugUtilsObjectNameEXT>, VkDevice, const VkDebugUtilsObjectNameInfoEXT* named) {
  return named->objectType == VK_OBJECT_TYPE_PIPELINE || named->objectType == VK_OBJECT_TYPE_SHADER_MODULE;
}

template <Call kCall, class F>
struct Through;

template <Call kCall, class R, class... A>
struct Through<kCall, R(VKAPI_PTR*)(A...)> {
  static inline R(VKAPI_PTR* real)(A...) = nullptr;

  static VKAPI_ATTR R VKAPI_CALL call(A... arguments) {
    if constexpr (kCall == Call::vkQueueSubmit2 || kCall == Call::vkQueueSubmit)
      if (ear.submits_left >= 0 && ear.submits_left-- <= 0) return ear.submits_left = 0, VK_ERROR_OUT_OF_DEVICE_MEMORY;
    bool silenced = !ear.computes && is_silenced<kCall>();
    if constexpr (requires { makes_up(Tag<kCall>(), arguments...); }) silenced = !ear.computes && makes_up(Tag<kCall>(), arguments...);
    const auto hear = [&] {
      if constexpr (requires { heard(Tag<kCall>(), arguments...); }) heard(Tag<kCall>(), arguments...);
    };
    if constexpr (std::is_void_v<R>) {
      if (!silenced) real(arguments...);
      hear();
    } else {
      const R result = silenced ? R{} : real(arguments...);
      if (result == VK_SUCCESS) hear();
      return result;
    }
  }
};

inline VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char* name) {
  const PFN_vkVoidFunction real = ear.get_device_proc_addr(device, name);
  if (real == nullptr) return real;
#define WEFT_CALL(function)                                   \
  if (std::strcmp(name, #function) == 0) {                    \
    using Heard = Through<Call::function, PFN_##function>;    \
    Heard::real = reinterpret_cast<PFN_##function>(real);     \
    return reinterpret_cast<PFN_vkVoidFunction>(Heard::call); \
  }
  WEFT_HEARD_FUNCTIONS(WEFT_CALL)
#undef WEFT_CALL
  return real;
}

inline VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction real = ear.get_instance_proc_addr(instance, name);
  if (std::strcmp(name, "vkGetDeviceProcAddr") != 0) return real;
  ear.get_device_proc_addr = reinterpret_cast<PFN_vkGetDeviceProcAddr>(real);
  return reinterpret_cast<PFN_vkVoidFunction>(device_function);
}

#undef WEFT_HEARD_FUNCTIONS

}  // namespace weft::overheard
