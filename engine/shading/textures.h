// Textures from files: read once each, mip levels made on the CPU.
#pragma once

#include <array>
#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "compute/raster.h"
#include "engine/image.h"

namespace weft::shading {

enum class Content { colour, data };  // sRGB, averaged in linear light; plain numbers

/// All levels of a picture down to 1 x 1, box filtered, four bytes a texel. Normals are averaged as they are, so that their
/// mean gets shorter where they disagree: the shader turns that into roughness.
std::vector<std::vector<std::byte>> mip_levels(const Image& image, Content content);

/// Owns the textures; the same file with the same content is loaded once.
class Textures {
 public:
  explicit Textures(const compute::Device& device) : device_(&device) {}

  /// `file` empty: a single texel of `fallback`. The pointer is valid as long as this.
  Result<const compute::DeviceImage*> load(const std::filesystem::path& file, Content content,
                                           std::array<std::uint8_t, 4> fallback);

 private:
  const compute::Device* device_;
  std::deque<compute::DeviceImage> images_;
  std::map<std::pair<std::string, Content>, const compute::DeviceImage*> found_;
};

}  // namespace weft::shading
