// Off-screen drawing: images, graphics pipelines and dynamic rendering for the shading pass.
//
// Kept as plain as compute is here: an image has one allocation and one view, a pipeline has fixed state except viewport
// and scissor, and layouts change where the caller says so.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compute/descriptors.h"
#include "compute/owned.h"

namespace weft::compute {

struct ImageRequest {
  std::string name;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkExtent2D size{1, 1};
  VkImageUsageFlags usage = 0;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  uint32_t levels = 1;
};

/// An image in device memory with a view of all its levels. Move-only.
class DeviceImage {
 public:
  /// Errors: a format the device does not have for this use, size or sample count; no memory left.
  static Result<DeviceImage> create(const Device& device, const ImageRequest& request);
  DeviceImage() = default;

  VkImage handle() const { return image_.get(); }
  VkImageView view() const { return view_.get(); }
  VkImageAspectFlags aspect() const;
  const ImageRequest& request() const { return request_; }

 private:
  OwnedMemory memory_;
  OwnedImage image_;
  OwnedImageView view_;
  ImageRequest request_;
};

/// How an image is used; a change from one use to another is a barrier.
struct ImageUse {
  VkImageLayout layout;
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
};
inline constexpr ImageUse kUnused{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_NONE};
inline constexpr ImageUse kColourTarget{VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                        VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
inline constexpr ImageUse kDepthTarget{
    VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
inline constexpr ImageUse kSampled{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
inline constexpr ImageUse kCopySource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                                      VK_ACCESS_2_TRANSFER_READ_BIT};
inline constexpr ImageUse kCopyDestination{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                                           VK_ACCESS_2_TRANSFER_WRITE_BIT};

/// Going from kUnused forgets what the image holds.
void change_use(const Device& device, VkCommandBuffer commands, const DeviceImage& image, const ImageUse& from, const ImageUse& to);

/// A texture ready to be sampled; `levels[i]` holds the tightly packed texels of level i. Submits and waits.
Result<DeviceImage> create_texture(const Device& device, std::string_view name, VkFormat format, VkExtent2D size,
                                   std::span<const std::vector<std::byte>> levels);

struct SamplerRequest {
  bool linear = true;   ///< within a level and between levels
  bool repeat = false;  ///< else the border is held
  bool compare = false; ///< reference <= texel
};
Result<OwnedSampler> create_sampler(const Device& device, std::string_view name, const SamplerRequest& request);

/// One binding of a set for drawing; which of the two is read depends on the layout's type.
struct DrawBinding {
  uint32_t binding = 0;
  VkDescriptorBufferInfo buffer{};
  VkDescriptorImageInfo image{};
};

/// One set with a pool of exactly its size.
class DrawSet {
 public:
  static Result<DrawSet> create(const Device& device, std::string_view name, const DescriptorLayout& layout,
                                std::span<const DrawBinding> bindings);
  DrawSet() = default;
  VkDescriptorSet handle() const { return set_; }

 private:
  OwnedDescriptorPool pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

struct DrawPipelineRequest {
  std::string name;
  std::span<const uint32_t> vertex;    ///< SPIR-V
  std::span<const uint32_t> fragment;  ///< empty: depth only
  VkPipelineLayout layout = VK_NULL_HANDLE;
  std::span<const VkVertexInputBindingDescription> bindings;
  std::span<const VkVertexInputAttributeDescription> attributes;
  VkFormat colour = VK_FORMAT_UNDEFINED;
  VkFormat depth = VK_FORMAT_UNDEFINED;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  VkCullModeFlags cull = VK_CULL_MODE_NONE;  ///< front faces run counter-clockwise
  VkCompareOp compare = VK_COMPARE_OP_ALWAYS;
  bool depth_write = false;
  float bias = 0;        ///< in units of the depth format's resolution
  float slope_bias = 0;  ///< per slope
};
/// Triangle lists, no blending; viewport and scissor are set by begin_drawing.
Result<OwnedPipeline> create_draw_pipeline(const Device& device, const DrawPipelineRequest& request);

/// What is drawn into. Everything is cleared at the start; with `resolve` the samples of `colour` are averaged into it.
struct DrawTargets {
  const DeviceImage* colour = nullptr;
  const DeviceImage* resolve = nullptr;
  const DeviceImage* depth = nullptr;
  float clear_depth = 1;
  bool keep_depth = true;
};
void begin_drawing(const Device& device, VkCommandBuffer commands, const DrawTargets& targets);
void end_drawing(const Device& device, VkCommandBuffer commands);

}  // namespace weft::compute
