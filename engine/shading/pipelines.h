// The graphics pipelines of a picture.
#pragma once

#include "compute/raster.h"

namespace weft::shading {

struct Pipelines {
  compute::OwnedPipelineLayout cloth_layout, solid_layout, screen_layout;
  compute::OwnedPipeline cloth_sun, cut_sun, solid_sun;        // into the shadow map
  compute::OwnedPipeline cloth_depth, cut_depth, solid_depth;  // into the depth that the occlusion is found from
  compute::OwnedPipeline occlusion, smooth;
  compute::OwnedPipeline cloth, solid, sky;                    // into the picture

  /// `frame_set` is set 0 of all, `cloth_set` set 1 of the cloth's. Those of cloth with holes are made where `cut` says so.
  static Result<Pipelines> create(const compute::Device& device, VkDescriptorSetLayout frame_set, VkDescriptorSetLayout cloth_set, bool cut);
};

}  // namespace weft::shading
