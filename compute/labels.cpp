// Asks the active tools. See labels.h.
#include "compute/labels.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <vector>

namespace weft::compute {

bool holds_labels(const VkPhysicalDeviceToolProperties& tool) {
  if (std::string_view(tool.layer) != "VK_LAYER_KHRONOS_validation") return true;
  // "239", and later "1.3.275": what counts is the last number.
  std::string_view version = tool.version;
  if (const std::size_t dot = version.rfind('.'); dot != std::string_view::npos) version.remove_prefix(dot + 1);
  uint32_t patch = 0;
  std::from_chars(version.data(), version.data() + version.size(), patch);
  return patch >= 243;
}

bool labels_hold(const Functions& fn, VkInstance instance, VkPhysicalDevice physical) {
  // Layers of that age speak through the extension alone, which they bring along; a device without it has no such layer.
  const auto tools_of = reinterpret_cast<PFN_vkGetPhysicalDeviceToolPropertiesEXT>(
      fn.vkGetInstanceProcAddr(instance, "vkGetPhysicalDeviceToolPropertiesEXT"));
  if (tools_of == nullptr) return true;
  uint32_t count = 0;
  tools_of(physical, &count, nullptr);
  std::vector<VkPhysicalDeviceToolProperties> tools(
      count, typed<VkPhysicalDeviceToolProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TOOL_PROPERTIES));
  tools_of(physical, &count, tools.data());
  tools.resize(count);
  return std::all_of(tools.begin(), tools.end(), holds_labels);
}

}  // namespace weft::compute
