// Opens the loader and fills the tables. See functions.h.
#include "compute/functions.h"

#include <utility>

#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif

namespace weft::compute {
namespace {

#if defined(_WIN32)
constexpr const char* kLibraries[] = {"vulkan-1.dll"};
void* open_library(const char* name) { return reinterpret_cast<void*>(LoadLibraryA(name)); }
void* find_symbol(void* library, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name));
}
void close_library(void* library) { FreeLibrary(static_cast<HMODULE>(library)); }
#else
#if defined(__APPLE__)
constexpr const char* kLibraries[] = {"libvulkan.1.dylib", "libvulkan.dylib", "libMoltenVK.dylib"};
#else
constexpr const char* kLibraries[] = {"libvulkan.so.1", "libvulkan.so"};
#endif
void* open_library(const char* name) { return dlopen(name, RTLD_NOW | RTLD_LOCAL); }
void* find_symbol(void* library, const char* name) { return dlsym(library, name); }
void close_library(void* library) { dlclose(library); }
#endif

Error missing(const char* name, const char* of) {
  return fail("the Vulkan ", of, " has no ", name, ": Weft needs Vulkan 1.1");
}

}  // namespace

Result<void> Functions::load_global(PFN_vkGetInstanceProcAddr from) {
  vkGetInstanceProcAddr = from;
#define WEFT_LOAD(name)                                                \
  name = reinterpret_cast<PFN_##name>(from(VK_NULL_HANDLE, #name));    \
  if (name == nullptr) return missing(#name, "loader");
  WEFT_GLOBAL_FUNCTIONS(WEFT_LOAD)
#undef WEFT_LOAD
  return {};
}

Result<void> Functions::load_instance(VkInstance instance) {
#define WEFT_FIND(name) name = reinterpret_cast<PFN_##name>(vkGetInstanceProcAddr(instance, #name));
#define WEFT_LOAD(name) \
  WEFT_FIND(name)       \
  if (name == nullptr) return missing(#name, "instance");
  WEFT_INSTANCE_FUNCTIONS(WEFT_LOAD)
  WEFT_OPTIONAL_INSTANCE_FUNCTIONS(WEFT_FIND)
#undef WEFT_LOAD
#undef WEFT_FIND
  return {};
}

Result<void> Functions::load_device(VkDevice device) {
#define WEFT_FIND(name) name = reinterpret_cast<PFN_##name>(vkGetDeviceProcAddr(device, #name));
#define WEFT_LOAD(name) \
  WEFT_FIND(name)       \
  if (name == nullptr) return missing(#name, "device");
  WEFT_DEVICE_FUNCTIONS(WEFT_LOAD)
#define WEFT_FIND_LATER(name) \
  WEFT_FIND(name)             \
  if (name == nullptr) name = reinterpret_cast<PFN_##name>(vkGetDeviceProcAddr(device, #name "KHR"));
  WEFT_LATER_DEVICE_FUNCTIONS(WEFT_FIND_LATER)
#undef WEFT_FIND_LATER
  WEFT_OPTIONAL_DEVICE_FUNCTIONS(WEFT_FIND)
#undef WEFT_LOAD
#undef WEFT_FIND
  return {};
}

// Vulkan does not tell what version an instance was created for, but vkGetDeviceProcAddr knows no function of a later one.
uint32_t Functions::version_of(VkDevice device) const {
  const auto has = [&](const char* name) { return vkGetDeviceProcAddr(device, name) != nullptr; };
  if (has("vkCmdPipelineBarrier2")) return VK_API_VERSION_1_3;
  if (has("vkGetSemaphoreCounterValue")) return VK_API_VERSION_1_2;
  return has("vkGetBufferMemoryRequirements2") ? VK_API_VERSION_1_1 : VK_API_VERSION_1_0;
}

Result<Loader> Loader::open() {
  Loader loader;
  for (const char* name : kLibraries) {
    loader.library_ = open_library(name);
    if (loader.library_ != nullptr) break;
  }
  if (loader.library_ == nullptr) {
    return fail("no Vulkan loader (", kLibraries[0], ") on this machine: on Debian, apt install libvulkan1 and a driver, ",
                "such as mesa-vulkan-drivers");
  }
  loader.get_instance_proc_addr_ =
      reinterpret_cast<PFN_vkGetInstanceProcAddr>(find_symbol(loader.library_, "vkGetInstanceProcAddr"));
  if (loader.get_instance_proc_addr_ == nullptr) {
    return fail("the Vulkan loader (", kLibraries[0], ") has no vkGetInstanceProcAddr: it is damaged or not a loader");
  }
  return loader;
}

Loader::Loader(Loader&& other) noexcept
    : library_(std::exchange(other.library_, nullptr)),
      get_instance_proc_addr_(std::exchange(other.get_instance_proc_addr_, nullptr)) {}

Loader& Loader::operator=(Loader&& other) noexcept {
  std::swap(library_, other.library_);
  std::swap(get_instance_proc_addr_, other.get_instance_proc_addr_);
  return *this;
}

Loader::~Loader() {
  if (library_ != nullptr) close_library(library_);
}

ErrorKind ResultName::error_kind() const {
  switch (result_) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY: return ErrorKind::memory;
    case VK_ERROR_DEVICE_LOST: return ErrorKind::device_lost;
    default: return ErrorKind::other;
  }
}

std::string result_text(VkResult result) {
#define WEFT_CASE(code) \
  case code: return #code;
  switch (result) {
    WEFT_CASE(VK_SUCCESS)
    WEFT_CASE(VK_NOT_READY)
    WEFT_CASE(VK_TIMEOUT)
    WEFT_CASE(VK_INCOMPLETE)
    WEFT_CASE(VK_SUBOPTIMAL_KHR)
    WEFT_CASE(VK_ERROR_OUT_OF_HOST_MEMORY)
    WEFT_CASE(VK_ERROR_OUT_OF_DEVICE_MEMORY)
    WEFT_CASE(VK_ERROR_INITIALIZATION_FAILED)
    WEFT_CASE(VK_ERROR_DEVICE_LOST)
    WEFT_CASE(VK_ERROR_MEMORY_MAP_FAILED)
    WEFT_CASE(VK_ERROR_LAYER_NOT_PRESENT)
    WEFT_CASE(VK_ERROR_EXTENSION_NOT_PRESENT)
    WEFT_CASE(VK_ERROR_FEATURE_NOT_PRESENT)
    WEFT_CASE(VK_ERROR_INCOMPATIBLE_DRIVER)
    WEFT_CASE(VK_ERROR_TOO_MANY_OBJECTS)
    WEFT_CASE(VK_ERROR_FORMAT_NOT_SUPPORTED)
    WEFT_CASE(VK_ERROR_FRAGMENTED_POOL)
    WEFT_CASE(VK_ERROR_OUT_OF_POOL_MEMORY)
    WEFT_CASE(VK_ERROR_FRAGMENTATION)
    WEFT_CASE(VK_ERROR_SURFACE_LOST_KHR)
    WEFT_CASE(VK_ERROR_OUT_OF_DATE_KHR)
    WEFT_CASE(VK_ERROR_UNKNOWN)
    default: return "VkResult " + std::to_string(static_cast<int>(result));
  }
#undef WEFT_CASE
}

}  // namespace weft::compute
