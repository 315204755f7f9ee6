// A Vulkan loader with a fault, for programs that open libvulkan.so.1: it is found first through LD_LIBRARY_PATH and passes everything
// on to the real one, through vulkan.h.
//
//   WEFT_FAULT=memory@17   the 17th call that may fail, from 0, has no memory      WEFT_FAULT=old       devices know Vulkan 1.0
//   WEFT_FAULT=lost@3      the device is lost at the 3rd submit or wait
//   WEFT_FAULT=none        nothing fails; only counted
//   WEFT_FAULT=lacking     devices lack synchronization2 and timelineSemaphore
//
// At its end WEFT_FAULT_REPORT, a file, says how many calls could have had the fault, which one had it, and what was never destroyed.
#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>

#include "tests/faulty/vulkan.h"

namespace {

using namespace weft::faulty;

std::string_view g_fault = "none";

PFN_vkGetPhysicalDeviceProperties g_properties = nullptr;
VKAPI_ATTR void VKAPI_CALL old_properties(VkPhysicalDevice device, VkPhysicalDeviceProperties* properties) {
  g_properties(device, properties);
  properties->apiVersion = VK_API_VERSION_1_0;
}

PFN_vkGetPhysicalDeviceFeatures2 g_features = nullptr;
VKAPI_ATTR void VKAPI_CALL lacking_features(VkPhysicalDevice device, VkPhysicalDeviceFeatures2* features) {
  g_features(device, features);
  for (auto* next = static_cast<VkBaseOutStructure*>(features->pNext); next != nullptr; next = next->pNext) {
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES)
      reinterpret_cast<VkPhysicalDeviceVulkan12Features*>(next)->timelineSemaphore = VK_FALSE;
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES)
      reinterpret_cast<VkPhysicalDeviceVulkan13Features*>(next)->synchronization2 = VK_FALSE;
  }
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL function(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction found = instance_function(instance, name);
  if (g_fault == "old" && std::strcmp(name, "vkGetPhysicalDeviceProperties") == 0) {
    g_properties = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(found);
    return reinterpret_cast<PFN_vkVoidFunction>(old_properties);
  }
  if (g_fault == "lacking" && std::strcmp(name, "vkGetPhysicalDeviceFeatures2") == 0) {
    g_features = reinterpret_cast<PFN_vkGetPhysicalDeviceFeatures2>(found);
    return reinterpret_cast<PFN_vkVoidFunction>(lacking_features);
  }
  return found;
}

struct Session {
  Session() {
    if (const char* fault = std::getenv("WEFT_FAULT")) g_fault = fault;
    void* real = dlopen(WEFT_VULKAN_LOADER, RTLD_NOW | RTLD_LOCAL);
    if (real == nullptr) return;
    faults.get_instance_proc_addr = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(real, "vkGetInstanceProcAddr"));
    const std::size_t at = g_fault.find('@');
    const long call = at == std::string_view::npos ? -1 : std::atol(g_fault.data() + at + 1);
    faults.plan(call, g_fault.starts_with("lost") ? VK_ERROR_DEVICE_LOST : VK_ERROR_OUT_OF_HOST_MEMORY);
  }
  ~Session() {
    const char* path = std::getenv("WEFT_FAULT_REPORT");
    std::FILE* report = path != nullptr ? std::fopen(path, "w") : nullptr;
    if (report == nullptr) return;
    std::fprintf(report, "%zu calls\nfailed: %s\nleft: %s\n", faults.counted.size(), faults.failed.c_str(), faults.left().c_str());
    std::fclose(report);
  }
} const g_session;

}  // namespace

extern "C" VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetInstanceProcAddr(VkInstance instance, const char* name) {
  return function(instance, name);
}
