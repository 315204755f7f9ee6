// Buffers, all of one memory type in one allocation.
//
// The plan knows every size before anything runs, so an arena asks for its memory once and never grows. Each request
// becomes a VkBuffer of its own at an aligned offset: it has a name in every tool, and validation knows where it ends.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compute/owned.h"

namespace weft::compute {

enum class Memory {
  device,    ///< where the GPU works; not mapped
  upload,    ///< written by the CPU, read by the GPU; mapped and coherent
  readback,  ///< written by the GPU, read by the CPU; mapped and coherent, cached where there is such a type
};

struct BufferRequest {
  std::string name;
  VkDeviceSize bytes = 0;  ///< rounded up to a multiple of 16; 0 becomes 16, so that it can still be bound
  VkBufferUsageFlags usage = 0;
  VkFormat texel_format = VK_FORMAT_UNDEFINED;  ///< set: the buffer gets a view; usage must include a texel buffer usage
};

/// One buffer of an arena; valid as long as the arena.
struct Buffer {
  std::string name;
  VkBuffer handle = VK_NULL_HANDLE;
  VkDeviceSize bytes = 0;
  VkBufferView view = VK_NULL_HANDLE;
  std::byte* mapped = nullptr;  ///< null in device memory
  VkBufferUsageFlags usage = 0;
};

/// Move-only. Buffers keep their address when an arena moves.
class Arena {
 public:
  /// Errors: a buffer above maxStorageBufferRange, maxTexelBufferElements or maxBufferSize, the whole above
  /// maxMemoryAllocationSize, a texel format the device has no buffers of, no memory left.
  static Result<Arena> create(const Device& device, Memory kind, std::string_view name,
                              std::span<const BufferRequest> requests);
  Arena() = default;

  const Buffer& operator[](size_t index) const { return buffers_[index]; }
  size_t size() const { return buffers_.size(); }
  std::span<const Buffer> buffers() const { return buffers_; }
  /// What was allocated, padding included.
  VkDeviceSize total_bytes() const { return total_bytes_; }

 private:
  // Members are destroyed from the last to the first: views, then buffers, then the memory under them.
  OwnedMemory memory_;
  std::vector<OwnedBuffer> handles_;
  std::vector<OwnedBufferView> views_;
  std::vector<Buffer> buffers_;
  VkDeviceSize total_bytes_ = 0;
};

/// Bytes for the start of a buffer, which needs VK_BUFFER_USAGE_TRANSFER_DST_BIT.
struct Upload {
  const Buffer* to = nullptr;
  std::span<const std::byte> bytes;
};

/// Copies all of them through one staging arena with one submit, and waits for it. Submits: see BorrowedDevice.
Result<void> upload_all(const Device& device, std::span<const Upload> uploads);
Result<void> upload(const Device& device, const Buffer& to, std::span<const std::byte> bytes);

/// Copies the buffer's first into.size() bytes and waits. Needs VK_BUFFER_USAGE_TRANSFER_SRC_BIT. Submits.
Result<void> read_back(const Device& device, const Buffer& from, std::span<std::byte> into);

}  // namespace weft::compute
