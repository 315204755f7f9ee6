// What Vulkan offers on this machine: the instance, its devices, and which of them to take. Used by device.cpp; the
// choice itself is pure and tested without a GPU.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compute/device.h"

namespace weft::compute {

/// Validation messages as they come; the messenger holds its address.
struct Messages {
  mutable std::mutex mutex;
  std::vector<std::string> heard;
  std::function<void(const std::string&)> listener;
};

/// An instance of our own, with its loader; destroyed together.
class Instance {
 public:
  /// `version`: of Vulkan, that VkApplicationInfo asks for.
  static Result<Instance> create(const DeviceChoice& choice, uint32_t version = VK_API_VERSION_1_3);
  Instance(Instance&& other) noexcept;
  Instance& operator=(Instance&&) = delete;
  ~Instance();

  VkInstance handle() const { return handle_; }
  const Functions& functions() const { return functions_; }
  const Messages& messages() const { return *messages_; }

 private:
  explicit Instance(Loader loader) : loader_(std::move(loader)) {}
  Loader loader_;
  Functions functions_;
  VkInstance handle_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::unique_ptr<Messages> messages_;
};

struct Candidate {
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  uint32_t queue_family = 0;
  VkQueueFlags queue_flags = 0;  // of that family
  uint32_t version = 0;          // of Vulkan, that it may be used as
  DeviceDescription description;
};

/// Of a device that a host lends: its queue family, and Functions::version_of. Of others the best family is taken.
struct Lent {
  std::optional<uint32_t> queue_family;
  uint32_t version = UINT32_MAX;
};
Candidate describe(const Functions& fn, VkPhysicalDevice physical, uint32_t index, const Lent& lent = {});

/// Whether Shading can draw on it with these features enabled.
inline bool can_draw(const Candidate& device, const Features& features) {
  return device.version >= VK_API_VERSION_1_3 && (device.queue_flags & VK_QUEUE_GRAPHICS_BIT) != 0 && features.dynamic_rendering &&
         features.synchronization2;
}

Result<std::vector<Candidate>> find_candidates(const Functions& fn, VkInstance instance);

/// The index of the device to take: by `wanted`, a part of its name or its index, or the best one if that is empty. Errors list the
/// devices that there are.
Result<uint32_t> choose_device(std::span<const DeviceDescription> devices, std::string_view wanted, bool graphics);

}  // namespace weft::compute
