// Everything that a picture is drawn into and read from on the way, and how the shaders reach it.
#pragma once

#include "compute/raster.h"
#include "shaders/shading/frame.h"

namespace weft::shading {

inline constexpr std::uint32_t kSunTexels = 2048;
inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
inline constexpr VkFormat kOpenFormat = VK_FORMAT_R8_UNORM;
inline constexpr VkFormat kPictureFormat = VK_FORMAT_R8G8B8A8_SRGB;
inline constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;

struct Targets {
  compute::DeviceImage sun_depth;        // the shadow map
  compute::DeviceImage camera_depth;     // one sample a pixel, for the ambient occlusion
  compute::DeviceImage rough_occlusion;  // 4 x 4 pattern
  compute::DeviceImage occlusion;
  compute::DeviceImage samples;          // four a pixel
  compute::DeviceImage sample_depth;
  compute::DeviceImage picture;

  static Result<Targets> create(const compute::Device& device, VkExtent2D size);
};

/// Set 0 of all pipelines: the frame block, its maps and samplers. Bindings as in sky.glsl, light.glsl and the .frag files.
struct FrameSet {
  compute::OwnedSampler texel_sampler, compare_sampler;
  compute::DescriptorLayout layout;
  compute::DrawSet set;   // of the targets that there are: another size has others

  static Result<FrameSet> create(const compute::Device& device);
  Result<compute::DrawSet> of(const compute::Device& device, const Targets& targets, const compute::Buffer& frame) const;
};

}  // namespace weft::shading
