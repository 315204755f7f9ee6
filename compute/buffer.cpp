// Lays buffers out in one allocation, and copies to and from them. See buffer.h.
#include "compute/buffer.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "compute/commands.h"

namespace weft::compute {
namespace {

constexpr VkDeviceSize kGranule = 16;  // bytes; one uvec4, so that a shader may always load whole vectors
constexpr VkBufferUsageFlags kTexelUsage =
    VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT;

VkDeviceSize align(VkDeviceSize offset, VkDeviceSize to) { return (offset + to - 1) / to * to; }

/// Bytes per element; 0 for a format that Weft has no use for in buffers.
VkDeviceSize texel_bytes(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_SNORM:
    case VK_FORMAT_R16G16_SFLOAT:
    case VK_FORMAT_R16G16_UINT:
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_R32_SINT:
    case VK_FORMAT_R32_SFLOAT: return 4;
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R16G16B16A16_SNORM:
    case VK_FORMAT_R16G16B16A16_UINT:
    case VK_FORMAT_R32G32_UINT:
    case VK_FORMAT_R32G32_SINT:
    case VK_FORMAT_R32G32_SFLOAT: return 8;
    case VK_FORMAT_R32G32B32A32_UINT:
    case VK_FORMAT_R32G32B32A32_SINT:
    case VK_FORMAT_R32G32B32A32_SFLOAT: return 16;
    default: return 0;
  }
}

Result<void> check(const Device& device, const BufferRequest& request) {
  const DeviceLimits& limits = device.limits();
  const auto too_big = [&](VkDeviceSize limit, const char* name) {
    return fail("buffer ", request.name, " of ", request.bytes, " bytes is above ", limit, " bytes, the ", name, " of ",
                device.name());
  };
  if (request.bytes > limits.max_buffer_bytes) return too_big(limits.max_buffer_bytes, "maxBufferSize");
  if (request.bytes > limits.max_allocation_bytes) {
    return too_big(limits.max_allocation_bytes, "maxMemoryAllocationSize");
  }
  if ((request.usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) && request.bytes > limits.max_storage_buffer_bytes) {
    return too_big(limits.max_storage_buffer_bytes, "maxStorageBufferRange");
  }
  if (request.texel_format == VK_FORMAT_UNDEFINED) return {};
  assert(request.usage & kTexelUsage);
  const VkDeviceSize element = texel_bytes(request.texel_format);
  VkFormatProperties format{};
  device.vk().vkGetPhysicalDeviceFormatProperties(device.physical(), request.texel_format, &format);
  VkFormatFeatureFlags needed = 0;
  if (request.usage & VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT) needed |= VK_FORMAT_FEATURE_UNIFORM_TEXEL_BUFFER_BIT;
  if (request.usage & VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT) needed |= VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT;
  if (element == 0 || (format.bufferFeatures & needed) != needed) {
    return fail("buffer ", request.name, " asks for texels of VkFormat ", static_cast<int>(request.texel_format),
                ", which ", device.name(), " does not have for buffers of usage ", request.usage & kTexelUsage);
  }
  if (request.bytes / element > limits.max_texel_buffer_elements) {
    return fail("buffer ", request.name, " of ", request.bytes, " bytes has ", request.bytes / element,
                " texels, above ", limits.max_texel_buffer_elements, ", the maxTexelBufferElements of ", device.name());
  }
  return {};
}

/// The first type that has all of `needed` and, where possible, `liked`; drivers list the better ones first.
uint32_t find_memory_type(const Device& device, uint32_t allowed, VkMemoryPropertyFlags needed,
                          VkMemoryPropertyFlags liked) {
  const VkPhysicalDeviceMemoryProperties& memory = device.memory();
  for (const VkMemoryPropertyFlags flags : {needed | liked, needed}) {
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
      if ((allowed & (1u << i)) && (memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
    }
  }
  return VK_MAX_MEMORY_TYPES;
}

uint32_t find_memory_type(const Device& device, uint32_t allowed, Memory kind) {
  constexpr VkMemoryPropertyFlags kMapped =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  switch (kind) {
    case Memory::device: return find_memory_type(device, allowed, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    case Memory::upload: return find_memory_type(device, allowed, kMapped, 0);
    case Memory::readback: return find_memory_type(device, allowed, kMapped, VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  }
  return VK_MAX_MEMORY_TYPES;
}

const char* kind_name(Memory kind) {
  return kind == Memory::device ? "device" : kind == Memory::upload ? "upload" : "readback";
}

}  // namespace

Result<Arena> Arena::create(const Device& device, Memory kind, std::string_view name,
                            std::span<const BufferRequest> requests) {
  const Functions& fn = device.vk();
  Arena arena;
  if (requests.empty()) return arena;
  std::vector<VkDeviceSize> offsets;
  arena.handles_.reserve(requests.size());   // before there is a handle that nobody owns
  arena.views_.reserve(requests.size());
  uint32_t allowed = ~0u;
  for (const BufferRequest& request : requests) {
    if (Result<void> checked = check(device, request); !checked) return checked.take_error();
    Buffer buffer;
    buffer.name = request.name;
    buffer.bytes = align(std::max<VkDeviceSize>(request.bytes, 1), kGranule);
    auto create = typed<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
    create.size = buffer.bytes;
    create.usage = buffer.usage = request.usage;
    const VkResult result = fn.vkCreateBuffer(device.handle(), &create, nullptr, &buffer.handle);
    if (result != VK_SUCCESS) {
      return fail("buffer ", request.name, " of ", buffer.bytes, " bytes could not be created: ", result_name(result));
    }
    arena.handles_.emplace_back(device, buffer.handle);
    device.name_object(VK_OBJECT_TYPE_BUFFER, buffer.handle, request.name);
    VkMemoryRequirements needs{};
    fn.vkGetBufferMemoryRequirements(device.handle(), buffer.handle, &needs);
    offsets.push_back(align(arena.total_bytes_, needs.alignment));
    // Each size is at most maxMemoryAllocationSize, far from the end of 64 bits, and so is the sum up to here.
    arena.total_bytes_ = offsets.back() + needs.size;
    if (arena.total_bytes_ > device.limits().max_allocation_bytes) {
      return fail("the ", kind_name(kind), " memory ", name, " reaches ", arena.total_bytes_, " bytes with buffer ",
                  request.name, ", above ", device.limits().max_allocation_bytes, " bytes, the maxMemoryAllocationSize of ",
                  device.name());
    }
    allowed &= needs.memoryTypeBits;
    arena.buffers_.push_back(std::move(buffer));
  }

  const uint32_t type = find_memory_type(device, allowed, kind);
  if (type == VK_MAX_MEMORY_TYPES) {
    return fail(device.name(), " has no ", kind_name(kind), " memory that all buffers of ", name, " can live in");
  }
  auto allocate = typed<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.allocationSize = arena.total_bytes_;
  allocate.memoryTypeIndex = type;
  auto flags = typed<VkMemoryAllocateFlagsInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO);
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  const auto has_address = [](const BufferRequest& request) { return (request.usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT) != 0; };
  if (std::any_of(requests.begin(), requests.end(), has_address)) allocate.pNext = &flags;
  const VkDeviceSize heap = device.memory().memoryHeaps[device.memory().memoryTypes[type].heapIndex].size;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const VkResult result = arena.total_bytes_ > heap
                              ? VK_ERROR_OUT_OF_DEVICE_MEMORY
                              : fn.vkAllocateMemory(device.handle(), &allocate, nullptr, &memory);
  if (result != VK_SUCCESS) {
    const auto largest = std::max_element(arena.buffers_.begin(), arena.buffers_.end(),
                                          [](const Buffer& a, const Buffer& b) { return a.bytes < b.bytes; });
    return fail("the ", kind_name(kind), " memory ", name, " of ", arena.total_bytes_, " bytes could not be allocated on ",
                device.name(), " (", result_name(result), "; the heap has ", heap, " bytes); the largest buffer is ",
                largest->name, " with ", largest->bytes, " bytes");
  }
  arena.memory_ = OwnedMemory(device, memory);
  device.name_object(VK_OBJECT_TYPE_DEVICE_MEMORY, memory, name);
  std::byte* mapped = nullptr;
  if (kind != Memory::device) {
    void* address = nullptr;
    const VkResult mapping = fn.vkMapMemory(device.handle(), memory, 0, VK_WHOLE_SIZE, 0, &address);
    if (mapping != VK_SUCCESS) {
      return fail("the ", kind_name(kind), " memory ", name, " of ", arena.total_bytes_, " bytes could not be mapped: ",
                  result_name(mapping));
    }
    mapped = static_cast<std::byte*>(address);
  }

  for (size_t i = 0; i < requests.size(); ++i) {
    Buffer& buffer = arena.buffers_[i];
    const VkResult bound = fn.vkBindBufferMemory(device.handle(), buffer.handle, memory, offsets[i]);
    if (bound != VK_SUCCESS) return fail("buffer ", buffer.name, " could not be bound: ", result_name(bound));
    if (mapped != nullptr) buffer.mapped = mapped + offsets[i];
    if (requests[i].texel_format == VK_FORMAT_UNDEFINED) continue;
    auto create = typed<VkBufferViewCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO);
    create.buffer = buffer.handle;
    create.format = requests[i].texel_format;
    create.range = buffer.bytes;
    const VkResult viewed = fn.vkCreateBufferView(device.handle(), &create, nullptr, &buffer.view);
    if (viewed != VK_SUCCESS) return fail("buffer ", buffer.name, " could not be viewed: ", result_name(viewed));
    arena.views_.emplace_back(device, buffer.view);
    device.name_object(VK_OBJECT_TYPE_BUFFER_VIEW, buffer.view, buffer.name);
  }
  return arena;
}

Result<void> upload_all(const Device& device, std::span<const Upload> uploads) {
  VkDeviceSize bytes = 0;
  for (const Upload& upload : uploads) {
    assert(upload.to != nullptr);
    if (upload.bytes.size() > upload.to->bytes) {
      return fail("an upload of ", upload.bytes.size(), " bytes does not fit buffer ", upload.to->name, " of ",
                  upload.to->bytes, " bytes");
    }
    bytes += align(upload.bytes.size(), kGranule);
  }
  if (bytes == 0) return {};
  const BufferRequest request{"staging", bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT};
  Result<Arena> staging = Arena::create(device, Memory::upload, "staging", {&request, 1});
  if (!staging) return staging.take_error();
  const Buffer& from = (*staging)[0];
  VkDeviceSize offset = 0;
  for (const Upload& upload : uploads) {
    if (upload.bytes.empty()) continue;
    std::memcpy(from.mapped + offset, upload.bytes.data(), upload.bytes.size());
    offset += align(upload.bytes.size(), kGranule);
  }
  return run_once(device, "upload", [&](VkCommandBuffer commands) {
    VkDeviceSize at = 0;
    for (const Upload& upload : uploads) {
      if (upload.bytes.empty()) continue;
      const VkBufferCopy region{at, 0, upload.bytes.size()};
      device.vk().vkCmdCopyBuffer(commands, from.handle, upload.to->handle, 1, &region);
      at += align(upload.bytes.size(), kGranule);
    }
  });
}

Result<void> upload(const Device& device, const Buffer& to, std::span<const std::byte> bytes) {
  const Upload one{&to, bytes};
  return upload_all(device, {&one, 1});
}

Result<void> read_back(const Device& device, const Buffer& from, std::span<std::byte> into) {
  if (into.size() > from.bytes) {
    return fail("reading ", into.size(), " bytes back from buffer ", from.name, " goes past its ", from.bytes, " bytes");
  }
  if (into.empty()) return {};
  const BufferRequest request{"readback of " + from.name, into.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  Result<Arena> staging = Arena::create(device, Memory::readback, request.name, {&request, 1});
  if (!staging) return staging.take_error();
  const Buffer& to = (*staging)[0];
  const VkBufferCopy region{0, 0, into.size()};
  Result<void> copied = run_once(device, "readback", [&](VkCommandBuffer commands) {
    device.vk().vkCmdCopyBuffer(commands, from.handle, to.handle, 1, &region);
  });
  if (copied) std::memcpy(into.data(), to.mapped, into.size());
  return copied;
}

}  // namespace weft::compute
