#include "engine/shading/targets.h"

#include <array>

namespace weft::shading {

using compute::Device;
using compute::DeviceImage;

Result<Targets> Targets::create(const Device& device, VkExtent2D size) {
  constexpr VkImageUsageFlags kDepth = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, kColour = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  constexpr VkImageUsageFlags kRead = VK_IMAGE_USAGE_SAMPLED_BIT;
  constexpr VkSampleCountFlagBits kOne = VK_SAMPLE_COUNT_1_BIT;
  Targets made;
  const struct {
    DeviceImage* image;
    compute::ImageRequest request;
  } wanted[] = {
      {&made.sun_depth, {"sun depth", kDepthFormat, {kSunTexels, kSunTexels}, kDepth | kRead, kOne}},
      {&made.camera_depth, {"camera depth", kDepthFormat, size, kDepth | kRead, kOne}},
      {&made.rough_occlusion, {"rough occlusion", kOpenFormat, size, kColour | kRead, kOne}},
      {&made.occlusion, {"occlusion", kOpenFormat, size, kColour | kRead, kOne}},
      {&made.samples, {"samples", kPictureFormat, size, kColour, kSamples}},
      {&made.sample_depth, {"sample depth", kDepthFormat, size, kDepth, kSamples}},
      {&made.picture, {"picture", kPictureFormat, size, kColour | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, kOne}},
  };
  for (const auto& [image, request] : wanted) {
    auto created = DeviceImage::create(device, request);
    if (!created) return created.take_error();
    *image = std::move(*created);
  }
  return made;
}

Result<FrameSet> FrameSet::create(const Device& device) {
  FrameSet made;
  auto texel = compute::create_sampler(device, "texel sampler", {.linear = false});
  if (!texel) return texel.take_error();
  made.texel_sampler = std::move(*texel);

  // Softer by itself where the device can filter comparisons; the spiral of taps does the rest.
  VkFormatProperties format;
  device.vk().vkGetPhysicalDeviceFormatProperties(device.physical(), kDepthFormat, &format);
  const bool filtered = format.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
  auto compare = compute::create_sampler(device, "shadow sampler", {.linear = filtered, .compare = true});
  if (!compare) return compare.take_error();
  made.compare_sampler = std::move(*compare);

  const std::array bindings = {
      compute::DescriptorBinding{0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},
      compute::DescriptorBinding{1, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE},
      compute::DescriptorBinding{2, VK_DESCRIPTOR_TYPE_SAMPLER},
      compute::DescriptorBinding{3, VK_DESCRIPTOR_TYPE_SAMPLER},
      compute::DescriptorBinding{4, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE},
      compute::DescriptorBinding{5, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE},
      compute::DescriptorBinding{6, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE},
  };
  constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  auto layout = compute::DescriptorLayout::create(device, "frame", bindings, kStages);
  if (!layout) return layout.take_error();
  made.layout = std::move(*layout);
  return made;
}

Result<compute::DrawSet> FrameSet::of(const Device& device, const Targets& targets, const compute::Buffer& frame) const {
  const auto sampler = [](std::uint32_t binding, const compute::OwnedSampler& what) {
    return compute::DrawBinding{binding, {}, {what.get(), VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED}};
  };
  const auto image = [](std::uint32_t binding, const DeviceImage& what) {
    return compute::DrawBinding{binding, {}, {VK_NULL_HANDLE, what.view(), compute::kSampled.layout}};
  };
  const std::array bound = {
      compute::DrawBinding{0, {frame.handle, 0, sizeof(Frame)}, {}},
      image(1, targets.sun_depth),
      sampler(2, texel_sampler),
      sampler(3, compare_sampler),
      image(4, targets.occlusion),
      image(5, targets.camera_depth),
      image(6, targets.rough_occlusion),
  };
  return compute::DrawSet::create(device, "frame", layout, bound);
}

}  // namespace weft::shading
