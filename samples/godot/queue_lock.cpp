// See samples/godot/queue_lock.h.
#include "samples/godot/queue_lock.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <vulkan/vk_layer.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <type_traits>

namespace weft_godot {
namespace {

constexpr const char* kLayer = "VK_LAYER_WEFT_queue_lock";

// What lies below, of each instance and device. The loader writes the same first word into a handle and into all that comes of it.
// Functions are fetched when it is made: later the loader answers with its own, which begin at the top again.
struct NextInstance {
  VkInstance instance;
  PFN_vkGetInstanceProcAddr find;
  PFN_vkDestroyInstance destroy;
};
struct NextDevice {
  VkDevice device;
  PFN_vkGetDeviceProcAddr find;
  PFN_vkDestroyDevice destroy;
  PFN_vkDeviceWaitIdle wait_idle;
  PFN_vkQueueSubmit submit;
  PFN_vkQueueSubmit2 submit2, submit2_khr;
  PFN_vkQueueBindSparse bind_sparse;
  PFN_vkQueuePresentKHR present;
  PFN_vkQueueWaitIdle queue_wait_idle;
};
using Key = const void*;
Key key_of(const void* handle) { return *static_cast<const void* const*>(handle); }

struct Chains {
  std::shared_mutex mutex;
  std::map<Key, NextInstance> instances;
  std::map<Key, NextDevice> devices;
};
Chains& chains() {
  static Chains all;
  return all;
}

// Who uses one queue shares `devices`; who uses all of a device has it alone.
struct Locks {
  std::shared_mutex devices;
  std::mutex mutex;
  std::map<VkQueue, std::mutex> queues;
  std::mutex& of(VkQueue queue) {
    const std::lock_guard lock(mutex);
    return queues[queue];
  }
};
Locks& locks() {
  static Locks all;
  return all;
}

// Of a device or a queue.
NextDevice below(const void* handle) {
  const std::shared_lock lock(chains().mutex);
  return chains().devices.at(key_of(handle));
}

template <class Function, class... Arguments>
VkResult alone_on(VkQueue queue, Function NextDevice::*call, Arguments... arguments) {
  const NextDevice next = below(queue);
  const std::shared_lock none_has_all(locks().devices);
  const std::lock_guard lock(locks().of(queue));
  return (next.*call)(queue, arguments...);
}

VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* submits, VkFence fence) {
  return alone_on(queue, &NextDevice::submit, count, submits, fence);
}
VKAPI_ATTR VkResult VKAPI_CALL submit2(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* submits, VkFence fence) {
  return alone_on(queue, &NextDevice::submit2, count, submits, fence);
}
VKAPI_ATTR VkResult VKAPI_CALL submit2_khr(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* submits, VkFence fence) {
  return alone_on(queue, &NextDevice::submit2_khr, count, submits, fence);
}
VKAPI_ATTR VkResult VKAPI_CALL bind_sparse(VkQueue queue, std::uint32_t count, const VkBindSparseInfo* binds, VkFence fence) {
  return alone_on(queue, &NextDevice::bind_sparse, count, binds, fence);
}
VKAPI_ATTR VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR* info) { return alone_on(queue, &NextDevice::present, info); }
VKAPI_ATTR VkResult VKAPI_CALL wait_idle(VkQueue queue) { return alone_on(queue, &NextDevice::queue_wait_idle); }
VKAPI_ATTR VkResult VKAPI_CALL device_wait_idle(VkDevice device) {
  const NextDevice next = below(device);
  const std::lock_guard all(locks().devices);
  return next.wait_idle(device);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find_of_instance(VkInstance instance, const char* name);
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find_of_device(VkDevice device, const char* name);

// The loader's own link in what an instance or a device is made with: what lies below.
template <class Info>
Info* link_in(const void* chain, VkStructureType type) {
  for (auto* at = static_cast<const VkBaseInStructure*>(chain); at != nullptr; at = at->pNext)
    if (at->sType == type)
      if (auto* info = reinterpret_cast<Info*>(const_cast<VkBaseInStructure*>(at)); info->function == VK_LAYER_LINK_INFO) return info;
  return nullptr;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator, VkInstance* made) {
  auto* link = link_in<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr find = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(find(nullptr, "vkCreateInstance"));
  if (create == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  const VkResult result = create(info, allocator, made);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(chains().mutex);
  chains().instances[key_of(*made)] = {*made, find, reinterpret_cast<PFN_vkDestroyInstance>(find(*made, "vkDestroyInstance"))};
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* allocator, VkDevice* made) {
  auto* link = link_in<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr find = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  const PFN_vkGetDeviceProcAddr find_of_it = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  VkInstance instance = VK_NULL_HANDLE;
  {
    const std::shared_lock lock(chains().mutex);
    if (const auto at = chains().instances.find(key_of(physical)); at != chains().instances.end()) instance = at->second.instance;
  }
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(find(instance, "vkCreateDevice"));
  if (create == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  const VkResult result = create(physical, info, allocator, made);
  if (result != VK_SUCCESS) return result;
  NextDevice next{};
  next.device = *made;
  next.find = find_of_it;
  const auto take = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(find_of_it(*made, name));
  };
  take(next.destroy, "vkDestroyDevice");
  take(next.wait_idle, "vkDeviceWaitIdle");
  take(next.submit, "vkQueueSubmit");
  take(next.submit2, "vkQueueSubmit2");
  take(next.submit2_khr, "vkQueueSubmit2KHR");
  take(next.bind_sparse, "vkQueueBindSparse");
  take(next.present, "vkQueuePresentKHR");
  take(next.queue_wait_idle, "vkQueueWaitIdle");
  const std::lock_guard lock(chains().mutex);
  chains().devices[key_of(*made)] = next;
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* allocator) {
  if (device == VK_NULL_HANDLE) return;
  const Key key = key_of(device);
  below(device).destroy(device, allocator);
  const std::lock_guard lock(chains().mutex);
  chains().devices.erase(key);
}

VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks* allocator) {
  if (instance == VK_NULL_HANDLE) return;
  const Key key = key_of(instance);
  PFN_vkDestroyInstance destroy = nullptr;
  {
    const std::lock_guard lock(chains().mutex);
    destroy = chains().instances.at(key).destroy;
    chains().instances.erase(key);
  }
  destroy(instance, allocator);
}

template <class Function>
PFN_vkVoidFunction erased(Function function) {
  return reinterpret_cast<PFN_vkVoidFunction>(function);
}

PFN_vkVoidFunction of_device(std::string_view name) {
  if (name == "vkGetDeviceProcAddr") return erased(find_of_device);
  if (name == "vkDestroyDevice") return erased(destroy_device);
  if (name == "vkQueueSubmit") return erased(submit);
  if (name == "vkQueueSubmit2") return erased(submit2);
  if (name == "vkQueueSubmit2KHR") return erased(submit2_khr);
  if (name == "vkQueueBindSparse") return erased(bind_sparse);
  if (name == "vkQueuePresentKHR") return erased(present);
  if (name == "vkQueueWaitIdle") return erased(wait_idle);
  if (name == "vkDeviceWaitIdle") return erased(device_wait_idle);
  return nullptr;
}

// Only of what is there below: a device without an extension has none of its functions.
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find_of_device(VkDevice device, const char* name) {
  PFN_vkVoidFunction found = nullptr;
  {
    const std::shared_lock lock(chains().mutex);
    const auto next = chains().devices.find(key_of(device));
    if (next == chains().devices.end()) return nullptr;
    found = next->second.find(next->second.device, name);
  }
  const PFN_vkVoidFunction own = of_device(name);
  return own != nullptr && found != nullptr ? own : found;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find_of_instance(VkInstance instance, const char* called) {
  const std::string_view name(called);
  if (name == "vkGetInstanceProcAddr") return erased(find_of_instance);
  if (name == "vkCreateInstance") return erased(create_instance);
  if (name == "vkCreateDevice") return erased(create_device);
  if (name == "vkDestroyInstance") return erased(destroy_instance);
  if (instance == VK_NULL_HANDLE) return nullptr;
  PFN_vkVoidFunction found = nullptr;
  {
    const std::shared_lock lock(chains().mutex);
    const auto next = chains().instances.find(key_of(instance));
    if (next == chains().instances.end()) return nullptr;
    found = next->second.find(next->second.instance, called);
  }
  const PFN_vkVoidFunction own = of_device(name);
  return own != nullptr && found != nullptr ? own : found;
}

std::filesystem::path& folder() {
  static std::filesystem::path of_manifest;
  return of_manifest;
}

// A variable of the environment, put back when it is no longer needed: programs that Godot starts have nothing to do with it.
struct Put {
  explicit Put(const char* variable) : variable(variable) {}
  const char* variable;
  std::optional<std::string> before = {};
  bool is_put = false;

  // Nearest to the application.
  void first(const std::string& text) {
    const char* held = getenv(variable);
    before = held != nullptr ? std::optional<std::string>(held) : std::nullopt;
    is_put = true;
    if (before && (*before + ":").find(text + ":") != std::string::npos) return;   // of a Godot that started this one
    setenv(variable, (before && !before->empty() ? text + ":" + *before : text).c_str(), 1);
  }
  void back() {
    if (!is_put) return;
    if (before) setenv(variable, before->c_str(), 1);
    else unsetenv(variable);
    is_put = false;
  }
};
Put path{"VK_ADD_LAYER_PATH"}, names{"VK_INSTANCE_LAYERS"};

}  // namespace

void name_queue_lock() {
  Dl_info here{};
  if (!folder().empty() || dladdr(reinterpret_cast<const void*>(&name_queue_lock), &here) == 0 || here.dli_fname == nullptr) return;
  std::error_code error;
  const std::filesystem::path library = std::filesystem::absolute(here.dli_fname, error);
  std::string place = (std::filesystem::temp_directory_path(error) / "weft_godot_XXXXXX").string();
  if (error || library.string().find_first_of("\"\\") != std::string::npos || mkdtemp(place.data()) == nullptr) return;
  folder() = place;
  std::ofstream manifest(folder() / "VkLayer_weft_queue_lock.json");
  manifest << R"({"file_format_version": "1.1.2", "layer": {"name": ")" << kLayer << R"(", "type": "GLOBAL", "library_path": ")"
           << library.string() << R"(", "api_version": "1.3.0", "implementation_version": "1",)"
           << R"( "description": "Lets one thread at a time use a queue", "functions":)"
           << R"( {"vkNegotiateLoaderLayerInterfaceVersion": "weft_godot_queue_lock"}}})" << '\n';
  manifest.close();
  if (!manifest) return forget_queue_lock();
  path.first(folder().string());
  names.first(kLayer);
}

void forget_queue_lock() {
  path.back();
  names.back();
  std::error_code error;
  if (!folder().empty()) std::filesystem::remove_all(folder(), error);
  folder().clear();
}

}  // namespace weft_godot

extern "C" __attribute__((visibility("default"))) VkResult VKAPI_CALL weft_godot_queue_lock(VkNegotiateLayerInterface* asked) {
  if (asked == nullptr || asked->sType != LAYER_NEGOTIATE_INTERFACE_STRUCT || asked->loaderLayerInterfaceVersion < 2)
    return VK_ERROR_INITIALIZATION_FAILED;
  asked->loaderLayerInterfaceVersion = 2;
  asked->pfnGetInstanceProcAddr = weft_godot::find_of_instance;
  asked->pfnGetDeviceProcAddr = weft_godot::find_of_device;
  asked->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
