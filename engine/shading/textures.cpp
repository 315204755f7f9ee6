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

// A texel that changes nothing.
Image nothing(Map map) {
  if (map == Map::normal) return {1, 1, {128, 128, 255, 255}};
  return {1, 1, {255, 255, 255, 255}};
}

std::uint8_t scaled(std::uint8_t value, double about, double by) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(about + by * (value - about)), 0L, 255L));
}

// One texel of a file, to one that cloth.frag reads.
void take(const Source& source, std::uint8_t* texel) {
  switch (source.map) {
    case Map::roughness: texel[1] = 255; break;   // the picture is grey, and all of it is as metallic as the scene says
    case Map::surface:
      texel[0] = texel[1];
      texel[1] = texel[2];
      break;
    case Map::normal:
      if (source.strength == 1) break;
      for (int c = 0; c < 2; ++c) texel[c] = scaled(texel[c], 127.5, source.strength);
      break;
    case Map::occlusion: texel[0] = scaled(texel[0], 255, source.strength); break;
    case Map::albedo: break;
  }
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

Result<const compute::DeviceImage*> Textures::load(const Source& source) {
  const auto key = std::tuple(source.map, source.file.string(), source.embedded, source.strength);
  if (const auto known = found_.find(key); known != found_.end()) return known->second;

  const bool is_there = source.embedded != nullptr || !source.file.empty();
  const std::string name = source.embedded != nullptr ? "an embedded picture" : source.file.string();
  Image image = nothing(source.map);
  if (is_there) {
    auto read = source.embedded != nullptr ? decode_image(*source.embedded, name) : read_image(source.file);
    if (!read) return read.take_error();
    image = std::move(*read);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) take(source, &image.rgba[i]);
  }
  const Content content = source.map == Map::albedo ? Content::colour : Content::data;
  const VkFormat format = content == Content::colour ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
  auto texture =
      compute::create_texture(*device_, "texture " + name, format, {image.width, image.height}, mip_levels(image, content));
  if (!texture) return texture.take_error();
  images_.push_back(std::move(*texture));
  return found_[key] = &images_.back();
}

}  // namespace weft::shading
