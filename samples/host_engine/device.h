// The host engine's own Vulkan: instance, device, queue, and the little it needs to own buffers.
//
// Nothing here knows of Weft, except lend(): what an engine hands over is six values that it has anyway. The four
// features that Weft asks of a device stand in create_device beside what the engine enables for itself.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "compute/device.h"
#include "compute/result.h"

namespace host {

using weft::fail;
using weft::Result;

/// What validation said; outlives the device, so that it also hears what is wrong with its end.
struct Complaints {
  std::atomic<std::uint32_t> count = 0;
};

struct DeviceRequest {
  std::string name;                  // "": the best; a number: its index; else part of its name
  Complaints* validation = nullptr;  // not null: Khronos and synchronization validation, which complain there and on stderr
};

class Device {
 public:
  /// Errors: no driver, no device that draws and computes, none of that name; no validation layer.
  static Result<std::unique_ptr<Device>> create(const DeviceRequest& request);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkDevice handle() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return family_; }
  std::string name() const;

  /// The type of memory among `types` (a bit each) with all of `wanted`.
  Result<std::uint32_t> memory_type(std::uint32_t types, VkMemoryPropertyFlags wanted) const;
  Result<void> submit(const VkSubmitInfo2& work) const;

  /// What Weft works with for as long as it lives: the engine stays the owner.
  weft::compute::BorrowedDevice lend() const;

 private:
  Device() = default;
  Result<void> create_instance(const DeviceRequest& request);
  Result<void> pick(const std::string& name);
  Result<void> create_device();

  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t family_ = 0;
};

/// A buffer that the CPU writes or reads in place.
class Buffer {
 public:
  static Result<Buffer> create(const Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage);
  /// With `contents` in it.
  static Result<Buffer> create(const Device& device, std::span<const std::byte> contents, VkBufferUsageFlags usage);
  Buffer() = default;
  Buffer(Buffer&& other) noexcept { *this = std::move(other); }
  Buffer& operator=(Buffer&& other) noexcept;
  ~Buffer();

  VkBuffer handle() const { return buffer_; }
  std::byte* mapped() const { return mapped_; }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::byte* mapped_ = nullptr;
};

/// A zeroed structure of Vulkan's that says what it is.
template <class T>
T typed(VkStructureType type) {
  T structure{};
  structure.sType = type;
  return structure;
}

/// Nothing, or a sentence with the code.
inline Result<void> checked(VkResult result, const char* what) {
  if (result != VK_SUCCESS) return fail(what, " failed (VkResult ", static_cast<int>(result), ")");
  return {};
}

}  // namespace host
