// Vulkan in which one call fails: every function goes through here, those that can fail are counted, the one that is chosen
// fails without having made anything, and what was made and not yet destroyed is counted by kind.
//
// Memory runs out at one call and is there again at the next. A lost device stays lost: its work stops, and every submit and
// wait after that fails too, as with real ones. Vulkan's functions carry no user pointer, hence the variable.
#pragma once

#include <atomic>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "compute/functions.h"
#include "tests/support/elsewhere.h"

namespace weft::faulty {

#define WEFT_FAULTY_FUNCTIONS(X) \
  WEFT_GLOBAL_FUNCTIONS(X) WEFT_INSTANCE_FUNCTIONS(X) WEFT_DEVICE_FUNCTIONS(X) WEFT_LATER_DEVICE_FUNCTIONS(X)

enum class Call {
#define WEFT_CALL(name) name,
  WEFT_FAULTY_FUNCTIONS(WEFT_CALL)
#undef WEFT_CALL
};

constexpr std::string_view name_of(Call call) {
  switch (call) {
#define WEFT_CALL(name) \
  case Call::name: return #name;
    WEFT_FAULTY_FUNCTIONS(WEFT_CALL)
#undef WEFT_CALL
  }
  return "";
}

/// Where a device that stops working is noticed.
constexpr bool notices_loss(Call call) {
  return call == Call::vkQueueSubmit2 || call == Call::vkQueueSubmit || call == Call::vkQueueWaitIdle || call == Call::vkDeviceWaitIdle ||
         call == Call::vkWaitForFences || call == Call::vkWaitSemaphores || call == Call::vkGetQueryPoolResults || call == Call::vkGetFenceStatus ||
         call == Call::vkGetSemaphoreCounterValue;
}

/// "Buffer" for vkCreateBuffer and vkDestroyBuffer; empty for what makes and ends nothing of its own (command buffers and
/// descriptor sets go with their pools).
constexpr std::string_view kind_of(Call call) {
  const std::string_view name = name_of(call);
  if (call == Call::vkAllocateMemory || call == Call::vkFreeMemory) return "Memory";
  if (call == Call::vkCreateComputePipelines || call == Call::vkCreateGraphicsPipelines) return "Pipeline";
  for (const std::string_view verb : {"vkCreate", "vkDestroy"})
    if (name.starts_with(verb)) return name.substr(verb.size());
  return {};
}

struct Faults {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;   // the real one
  PFN_vkGetDeviceProcAddr get_device_proc_addr = nullptr;
  VkResult fault = VK_ERROR_OUT_OF_DEVICE_MEMORY;               // or VK_ERROR_DEVICE_LOST
  std::atomic<long> fail_at = -1;                               // the call that has it, from 0; -1: none
  std::atomic<bool> lost = false;
  std::atomic<std::uint32_t> most_storage = 0;                  // bytes, the maxStorageBufferRange that the device says it has; 0: its own
  VkQueue queue = VK_NULL_HANDLE;                               // the last one that was submitted to
  std::mutex mutex;                                             // for what follows
  std::vector<Call> counted;                                    // which those were
  std::string failed;                                           // the function that had the fault
  std::map<std::string_view, long> alive;

  void plan(long at, VkResult with) {
    fail_at = at;
    fault = with;
    lost = false;
    const std::lock_guard lock(mutex);
    failed.clear();
    counted.clear();
  }
  /// "2 Buffer, 1 Fence"; empty when all is gone.
  std::string left() {
    const std::lock_guard lock(mutex);
    std::string text;
    for (const auto& [kind, count] : alive)
      if (count != 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + std::string(kind);
    return text;
  }
};
inline Faults faults;

template <Call kCall, class F>
struct Through;

template <Call kCall, class R, class... A>
struct Through<kCall, R(VKAPI_PTR*)(A...)> {
  using Function = R(VKAPI_PTR*)(A...);
  static inline Function real = nullptr;

  static VKAPI_ATTR R VKAPI_CALL call(A... arguments);
};

// What a lost device still has under way must not run into the buffers that are about to go.
inline void stop_work();

inline bool fails(Call call) {
  const bool losing = faults.fault == VK_ERROR_DEVICE_LOST;
  if (losing && !notices_loss(call)) return false;
  if (losing && faults.lost) return true;
  {
    const std::lock_guard lock(faults.mutex);
    faults.counted.push_back(call);
    if (static_cast<long>(faults.counted.size()) - 1 != faults.fail_at) return false;
    faults.failed = name_of(call);
  }
  if (losing) {
    stop_work();
    faults.lost = true;
  }
  return true;
}

template <Call kCall, class R, class... A>
VKAPI_ATTR R VKAPI_CALL Through<kCall, R(VKAPI_PTR*)(A...)>::call(A... arguments) {
  constexpr std::string_view kind = kind_of(kCall);
  const test::Elsewhere elsewhere;
  const auto count = [&](long by) {
    const std::lock_guard lock(faults.mutex);
    faults.alive[kind] += by;
  };
  if constexpr (kCall == Call::vkQueueSubmit2 || kCall == Call::vkQueueSubmit) faults.queue = std::get<0>(std::tuple(arguments...));
  if constexpr (std::is_same_v<R, VkResult>) {
    if (fails(kCall)) {
      if constexpr (kCall == Call::vkEndCommandBuffer) real(arguments...);   // also one that fails ends the recording
      return faults.fault;
    }
    const VkResult result = real(arguments...);
    if (!kind.empty() && result == VK_SUCCESS) count(1);
    return result;
  } else {
    // vkDestroyInstance and vkDestroyDevice name the thing itself first, the others its device.
    if constexpr (!kind.empty() && std::is_void_v<R>)
      if (std::get<sizeof...(A) - 2>(std::tuple(arguments...)) != VK_NULL_HANDLE) count(-1);
    if constexpr (kCall == Call::vkGetPhysicalDeviceProperties) {
      real(arguments...);
      if (faults.most_storage > 0) std::get<1>(std::tuple(arguments...))->limits.maxStorageBufferRange = faults.most_storage;
    } else {
      return real(arguments...);
    }
  }
}

/// The wrapper of a function, once the real one is known; `real` where there is none.
inline PFN_vkVoidFunction through(std::string_view name, PFN_vkVoidFunction real) {
  if (real == nullptr) return real;
#define WEFT_CALL(function)                                               \
  if (name == #function) {                                                \
    using Wrapped = Through<Call::function, PFN_##function>;              \
    Wrapped::real = reinterpret_cast<PFN_##function>(real);               \
    return reinterpret_cast<PFN_vkVoidFunction>(Wrapped::call);           \
  }
  WEFT_FAULTY_FUNCTIONS(WEFT_CALL)
#undef WEFT_CALL
  return real;
}

inline void stop_work() {
  if (const auto wait = Through<Call::vkQueueWaitIdle, PFN_vkQueueWaitIdle>::real; wait != nullptr && faults.queue != VK_NULL_HANDLE)
    wait(faults.queue);
}

inline VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char* name) {
  return through(name, faults.get_device_proc_addr(device, name));
}

inline VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction real = faults.get_instance_proc_addr(instance, name);
  if (std::strcmp(name, "vkGetInstanceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(instance_function);
  if (std::strcmp(name, "vkGetDeviceProcAddr") != 0) return through(name, real);
  faults.get_device_proc_addr = reinterpret_cast<PFN_vkGetDeviceProcAddr>(real);
  return reinterpret_cast<PFN_vkVoidFunction>(device_function);
}

}  // namespace weft::faulty
