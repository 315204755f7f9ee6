// Textures of looks: each read once, mip levels made on the CPU.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "compute/raster.h"
#include "engine/image.h"
#include "engine/shading/looks.h"

namespace weft::shading {

enum class Content { colour, data };  // sRGB, averaged in linear light; plain numbers

/// All levels of a picture down to 1 x 1, box filtered, four bytes a texel. Normals are averaged as they are, so that their
/// mean gets shorter where they disagree: the shader turns that into roughness.
std::vector<std::vector<std::byte>> mip_levels(const Image& image, Content content);

/// Owns the textures; the same picture for the same map is loaded once.
class Textures {
 public:
  explicit Textures(const compute::Device& device) : device_(&device) {}

  /// As cloth.frag reads it: roughness in red and metal in green, slopes and occlusion as strong as the source says. The pointer is
  /// valid as long as this.
  Result<const compute::DeviceImage*> load(const Source& source);

 private:
  const compute::Device* device_;
  std::deque<compute::DeviceImage> images_;
  std::map<std::tuple<Map, std::string, const std::string*, double>, const compute::DeviceImage*> found_;
};

}  // namespace weft::shading
