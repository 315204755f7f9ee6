#include "engine/shading/textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace weft::shading {
namespace {

double to_linear(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }
double to_srgb(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }

std::array<float, 256> linear_table() {
  std::array<float, 256> table;
  for (std::size_t i = 0; i < 256; ++i) table[i] = static_cast<float>(to_linear(static_cast<double>(i) / 255));
  return table;
}

std::vector<std::byte> bytes_of(const std::vector<float>& texels, Content content) {
  std::vector<std::byte> out(texels.size());
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const double value = content == Content::colour && i % 4 != 3 ? to_srgb(texels[i]) : texels[i];
    out[i] = static_cast<std::byte>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
  }
  return out;
}

}  // namespace

std::vector<std::vector<std::byte>> mip_levels(const Image& image, Content content) {
  const std::array<float, 256> linear = linear_table();
  std::vector<float> texels(image.rgba.size());
  for (std::size_t i = 0; i < texels.size(); ++i)
    texels[i] = content == Content::colour && i % 4 != 3 ? linear[image.rgba[i]] : static_cast<float>(image.rgba[i]) / 255;

  std::vector<std::vector<std::byte>> levels(1);
  levels[0].resize(image.rgba.size());
  std::memcpy(levels[0].data(), image.rgba.data(), image.rgba.size());
  std::size_t width = image.width, height = image.height;
  while (width > 1 || height > 1) {
    const std::size_t w = std::max<std::size_t>(width / 2, 1), h = std::max<std::size_t>(height / 2, 1);
    std::vector<float> half(4 * w * h);
    for (std::size_t y = 0; y < h; ++y)
      for (std::size_t x = 0; x < w; ++x)
        for (std::size_t c = 0; c < 4; ++c) {
          const std::size_t x1 = std::min(2 * x + 1, width - 1), y1 = std::min(2 * y + 1, height - 1);
          const auto at = [&](std::size_t i, std::size_t j) { return texels[4 * (j * width + i) + c]; };
          half[4 * (y * w + x) + c] = 0.25f * (at(2 * x, 2 * y) + at(x1, 2 * y) + at(2 * x, y1) + at(x1, y1));
        }
    texels = std::move(half);
    width = w;
    height = h;
    levels.push_back(bytes_of(texels, content));
  }
  return levels;
}

Result<const compute::DeviceImage*> Textures::load(const std::filesystem::path& file, Content content,
                                                   std::array<std::uint8_t, 4> fallback) {
  // A fallback's name holds its texel: fallbacks differ in colour, not in path.
  std::string name = file.string();
  if (file.empty())
    for (std::uint8_t value : fallback) name += std::to_string(value) + " ";
  const auto key = std::pair(name, content);
  if (const auto known = found_.find(key); known != found_.end()) return known->second;

  Image image{1, 1, {fallback.begin(), fallback.end()}};
  if (!file.empty()) {
    auto read = read_image(file);
    if (!read) return read.take_error();
    image = std::move(*read);
  }
  const VkFormat format = content == Content::colour ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
  auto texture =
      compute::create_texture(*device_, "texture " + name, format, {image.width, image.height}, mip_levels(image, content));
  if (!texture) return texture.take_error();
  images_.push_back(std::move(*texture));
  return found_[key] = &images_.back();
}

}  // namespace weft::shading
