// Finds devices, says what each can do and why Weft cannot use it, and picks one. See inventory.h.
#include "compute/inventory.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace weft::compute {
namespace {

constexpr VkDeviceSize kEndless = VkDeviceSize{1} << 62;  // bytes; no memory is larger, and sums stay in 64 bits

std::string version_text(uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

const char* type_name(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return "software";
    default: return "other";
  }
}

/// Lower is better.
int rank(const DeviceDescription& device) {
  constexpr std::array<std::string_view, 4> kOrder = {"discrete", "integrated", "virtual", "software"};
  return static_cast<int>(std::find(kOrder.begin(), kOrder.end(), device.type) - kOrder.begin());
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

std::string list(std::span<const DeviceDescription> devices) {
  std::string text;
  for (const DeviceDescription& device : devices) {
    if (!text.empty()) text += "; ";
    text += std::to_string(device.index) + ": " + device.name;
    if (!device.refusal.empty()) text += " (cannot be used: " + device.refusal + ")";
  }
  return text;
}

/// What a device of Vulkan 1.1 says beyond its VkPhysicalDeviceProperties, and one of a later version.
struct Further {
  VkPhysicalDeviceProperties2 properties =
      typed<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  VkPhysicalDeviceMaintenance3Properties memory =
      typed<VkPhysicalDeviceMaintenance3Properties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES);
  VkPhysicalDeviceSubgroupProperties subgroup =
      typed<VkPhysicalDeviceSubgroupProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES);
  VkPhysicalDeviceDriverProperties driver =
      typed<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
  VkPhysicalDeviceMaintenance4Properties buffers =
      typed<VkPhysicalDeviceMaintenance4Properties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES);

  Further(const Functions& fn, VkPhysicalDevice physical, uint32_t version) {
    properties.pNext = &memory;
    memory.pNext = &subgroup;
    if (version >= VK_API_VERSION_1_2) subgroup.pNext = &driver;
    if (version >= VK_API_VERSION_1_3) driver.pNext = &buffers;
    fn.vkGetPhysicalDeviceProperties2(physical, &properties);
  }
  Further(const Further&) = delete;   // they point at each other
  Further& operator=(const Further&) = delete;
};

/// A family that also draws is preferred; nothing when none has compute.
std::optional<uint32_t> best_family(std::span<const VkQueueFamilyProperties> families) {
  std::optional<uint32_t> best;
  for (uint32_t i = 0; i < families.size(); ++i) {
    const VkQueueFlags flags = families[i].queueFlags;
    if (families[i].queueCount == 0 || !(flags & VK_QUEUE_COMPUTE_BIT)) continue;
    if (flags & VK_QUEUE_GRAPHICS_BIT) return i;
    if (!best) best = i;
  }
  return best;
}

}  // namespace

Candidate describe(const Functions& fn, VkPhysicalDevice physical, uint32_t index, const Lent& lent) {
  Candidate found;
  found.physical = physical;
  fn.vkGetPhysicalDeviceProperties(physical, &found.properties);
  fn.vkGetPhysicalDeviceMemoryProperties(physical, &found.memory);
  const VkPhysicalDeviceProperties& properties = found.properties;
  DeviceDescription& out = found.description;
  out.index = index;
  out.name = properties.deviceName;
  out.type = type_name(properties.deviceType);
  out.api = version_text(properties.apiVersion);
  out.driver = "version " + std::to_string(properties.driverVersion);
  for (uint32_t i = 0; i < found.memory.memoryHeapCount; ++i) {
    const VkMemoryHeap& heap = found.memory.memoryHeaps[i];
    if (heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) out.memory_bytes = std::max(out.memory_bytes, heap.size);
  }
  const VkPhysicalDeviceLimits& from = properties.limits;
  DeviceLimits& limits = out.limits;
  limits.max_storage_buffer_bytes = from.maxStorageBufferRange;
  limits.max_texel_buffer_elements = from.maxTexelBufferElements;
  limits.storage_buffer_alignment = from.minStorageBufferOffsetAlignment;
  limits.texel_buffer_alignment = from.minTexelBufferOffsetAlignment;
  limits.max_storage_buffers_per_stage = from.maxPerStageDescriptorStorageBuffers;
  limits.max_push_constant_bytes = from.maxPushConstantsSize;
  limits.shared_memory_bytes = from.maxComputeSharedMemorySize;
  limits.max_workgroup_invocations = std::min(from.maxComputeWorkGroupInvocations, from.maxComputeWorkGroupSize[0]);
  limits.max_workgroups_x = from.maxComputeWorkGroupCount[0];
  found.version = std::min(properties.apiVersion, lent.version);
  if (found.version < VK_API_VERSION_1_1) {
    out.refusal = "it has Vulkan " + version_text(found.version) + ", and Weft needs 1.1";
    return found;
  }
  const Further further(fn, physical, found.version);
  if (found.version >= VK_API_VERSION_1_2) out.driver = std::string(further.driver.driverName) + " " + further.driver.driverInfo;
  limits.max_allocation_bytes = std::min(further.memory.maxMemoryAllocationSize, kEndless);
  limits.max_buffer_bytes = limits.max_allocation_bytes;
  if (found.version >= VK_API_VERSION_1_3) limits.max_buffer_bytes = std::min(further.buffers.maxBufferSize, kEndless);
  limits.subgroup_size = further.subgroup.subgroupSize;
  out.features = supported_features(fn, physical, found.version);
  uint32_t count = 0;
  fn.vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  fn.vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  const std::optional<uint32_t> family = lent.queue_family ? lent.queue_family : best_family(families);
  if (!family) {
    out.refusal = "it has no queue with compute among its " + std::to_string(count) + " queue families";
    return found;
  }
  if (*family >= count || !(families[*family].queueFlags & VK_QUEUE_COMPUTE_BIT)) {
    out.refusal = "queue family " + std::to_string(*family) + " of " + std::to_string(count) + " has no compute";
    return found;
  }
  found.queue_family = *family;
  found.queue_flags = families[*family].queueFlags;
  limits.timestamp_bits = families[*family].timestampValidBits;
  limits.timestamp_period_ns = limits.timestamp_bits > 0 ? static_cast<double>(from.timestampPeriod) : 0.0;
  out.draws = can_draw(found, out.features);
  return found;
}

Result<std::vector<Candidate>> find_candidates(const Functions& fn, VkInstance instance) {
  uint32_t count = 0;
  VkResult result = fn.vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  if (result == VK_SUCCESS && count > 0) {
    result = fn.vkEnumeratePhysicalDevices(instance, &count, devices.data());
  }
  if (result != VK_SUCCESS || count == 0) {
    return fail("no Vulkan device on this machine (the loader reports ", count, " devices, ", result_name(result),
                "): install a driver; on Debian, apt install mesa-vulkan-drivers brings a software one");
  }
  std::vector<Candidate> candidates;
  for (uint32_t i = 0; i < count; ++i) candidates.push_back(describe(fn, devices[i], i));
  return candidates;
}

Result<uint32_t> choose_device(std::span<const DeviceDescription> devices, std::string_view wanted, bool graphics) {
  const auto usable = [&](const DeviceDescription& device) {
    return device.refusal.empty() && (device.draws || !graphics);
  };
  const auto why_not = [&](const DeviceDescription& device) {
    if (!device.refusal.empty()) return device.refusal;
    return std::string("it cannot draw: no queue with graphics, or not the features of Vulkan 1.3 that pictures take");
  };
  const bool is_number =
      !wanted.empty() && std::all_of(wanted.begin(), wanted.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  if (is_number) {
    uint32_t index = 0;
    const auto parsed = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
    if (parsed.ec != std::errc() || index >= devices.size()) {
      return fail("there is no Vulkan device ", wanted, "; there are: ", list(devices));
    }
    if (!usable(devices[index])) {
      return fail("Vulkan device ", index, " (", devices[index].name, ") cannot be used: ", why_not(devices[index]));
    }
    return index;
  }
  const DeviceDescription* best = nullptr;
  const DeviceDescription* refused = nullptr;
  for (const DeviceDescription& device : devices) {
    if (lower(device.name).find(lower(wanted)) == std::string::npos) continue;
    if (!usable(device)) {
      if (refused == nullptr) refused = &device;
    } else if (best == nullptr || rank(device) < rank(*best)) {
      best = &device;
    }
  }
  if (best != nullptr) return static_cast<uint32_t>(best - devices.data());
  if (refused != nullptr && wanted.empty() && devices.size() > 1) {
    return fail("none of the ", devices.size(), " Vulkan devices can be used; there are: ", list(devices));
  }
  if (refused != nullptr) return fail("the Vulkan device ", refused->name, " cannot be used: ", why_not(*refused));
  return fail("no Vulkan device is called \"", wanted, "\"; there are: ", list(devices));
}

}  // namespace weft::compute
