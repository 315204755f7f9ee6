// See samples/godot/vertex_texture.h.
#include "samples/godot/vertex_texture.h"

namespace weft_godot {
namespace {

using godot::Variant;
using weft::fail;
using weft::Result;

// Of Godot's RenderingDevice
constexpr int k2dArray = 5;               // TEXTURE_TYPE_2D_ARRAY
constexpr int kRgba32f = 108;             // DATA_FORMAT_R32G32B32A32_SFLOAT
constexpr int kSampledCopied = 1 | 128;   // TEXTURE_USAGE_SAMPLING_BIT, TEXTURE_USAGE_CAN_COPY_FROM_BIT

}  // namespace

Result<std::unique_ptr<VertexTexture>> VertexTexture::create(const weft::Simulation& simulation) {
  std::unique_ptr<VertexTexture> made(new VertexTexture(simulation.device(), simulation.positions(), simulation.normals()));
  made->rows_ = (made->positions_.count + kWidth - 1) / kWidth;
  const std::uint32_t most = simulation.device().properties().limits.maxImageDimension2D;
  if (made->rows_ > most)
    return fail(weft::ErrorKind::other, made->positions_.count, " vertices are more than the ", std::uint64_t(most) * kWidth,
                " that fit into a texture of this device");
  if (auto done = made->make_image(); !done) return done.take_error();
  const Variant device = godot::singleton("RenderingServer").call("get_rendering_device");
  made->rid_ = device
                   .call("texture_create_from_extension", k2dArray, kRgba32f, 0, kSampledCopied,
                         static_cast<std::int64_t>(reinterpret_cast<std::uintptr_t>(made->image_)), kWidth, made->rows_, 1, 2 * kSlots, 1)
                   .to_rid();
  if (made->rid_.id == 0) return fail(weft::ErrorKind::other, "Godot does not take the texture of vertices");
  return made;
}

Result<void> VertexTexture::make_image() {
  const weft::compute::Functions& vk = device_->vk();
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = VK_FORMAT_R32G32B32A32_SFLOAT;
  info.extent = {kWidth, rows_, 1};
  info.mipLevels = 1;
  info.arrayLayers = 2 * kSlots;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  if (vk.vkCreateImage(device_->handle(), &info, nullptr, &image_) != VK_SUCCESS)
    return fail(weft::ErrorKind::memory, "an image of ", kWidth, " x ", rows_, " vertices cannot be made");
  VkMemoryRequirements needed;
  vk.vkGetImageMemoryRequirements(device_->handle(), image_, &needed);
  std::uint32_t type = 0;
  const VkPhysicalDeviceMemoryProperties& all = device_->memory();
  while (type < all.memoryTypeCount &&
         (!(needed.memoryTypeBits >> type & 1) || !(all.memoryTypes[type].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)))
    ++type;
  const VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needed.size, type};
  if (type == all.memoryTypeCount || vk.vkAllocateMemory(device_->handle(), &allocate, nullptr, &memory_) != VK_SUCCESS ||
      vk.vkBindImageMemory(device_->handle(), image_, memory_, 0) != VK_SUCCESS)
    return fail(weft::ErrorKind::memory, "there is no memory of ", needed.size, " bytes for the texture of vertices");
  return {};
}

VertexTexture::~VertexTexture() {
  free_rid();
  device_->vk().vkDestroyImage(device_->handle(), image_, nullptr);
  device_->vk().vkFreeMemory(device_->handle(), memory_, nullptr);
}

void VertexTexture::free_rid() {
  if (rid_.id != 0) godot::singleton("RenderingServer").call("get_rendering_device").call("free_rid", rid_);
  rid_ = {};
}

void VertexTexture::barrier(VkCommandBuffer commands, std::uint32_t first, std::uint32_t layers, bool before) const {
  constexpr VkPipelineStageFlags kDraws = VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT;
  constexpr VkPipelineStageFlags kCopies = VK_PIPELINE_STAGE_TRANSFER_BIT;
  constexpr VkImageLayout kRead = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, kWritten = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  VkImageMemoryBarrier barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
  barrier.srcAccessMask = before ? 0 : VK_ACCESS_TRANSFER_WRITE_BIT;   // what was read is only waited for
  barrier.dstAccessMask = before ? VK_ACCESS_TRANSFER_WRITE_BIT : VK_ACCESS_SHADER_READ_BIT;
  barrier.oldLayout = !before ? kWritten : is_new_ ? VK_IMAGE_LAYOUT_UNDEFINED : kRead;
  barrier.newLayout = before ? kWritten : kRead;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image_;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, first, layers};
  device_->vk().vkCmdPipelineBarrier(commands, before ? kDraws : kCopies, before ? kCopies : kDraws, 0, 0, nullptr, 0, nullptr, 1,
                                     &barrier);
}

// Whole rows, and what is left of the last.
void VertexTexture::copy(VkCommandBuffer commands, const weft::FrameView& from, std::uint32_t layer) const {
  const std::uint32_t whole = from.count / kWidth, rest = from.count % kWidth;
  VkBufferImageCopy regions[2]{};
  std::uint32_t count = 0;
  const auto add = [&](std::uint32_t row, std::uint32_t width, std::uint32_t rows) {
    VkBufferImageCopy& region = regions[count++];
    region.bufferOffset = from.offset + VkDeviceSize(row) * kWidth * from.stride;
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, layer, 1};
    region.imageOffset = {0, static_cast<std::int32_t>(row), 0};
    region.imageExtent = {width, rows, 1};
  };
  if (whole > 0) add(0, kWidth, whole);
  if (rest > 0) add(whole, rest, 1);
  device_->vk().vkCmdCopyBufferToImage(commands, from.buffer, image_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, count, regions);
}

void VertexTexture::record(VkCommandBuffer commands, std::uint32_t slot) {
  const std::uint32_t first = is_new_ ? 0 : 2 * slot, layers = is_new_ ? 2 * kSlots : 2;
  barrier(commands, first, layers, true);
  copy(commands, positions_, 2 * slot);
  copy(commands, normals_, 2 * slot + 1);
  barrier(commands, first, layers, false);
  is_new_ = false;
}

}  // namespace weft_godot
