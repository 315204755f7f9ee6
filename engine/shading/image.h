// Pictures in memory and on disk: eight bits a channel, four channels, the first row on top.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "compute/result.h"

namespace weft {

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // 4 width height bytes
};

/// Reads a PNG or JPEG of at most 16384 pixels a side. Errors: missing, unreadable or foreign file, one too large.
Result<Image> read_image(const std::filesystem::path& file);

/// Writes under a temporary name and renames, so that nobody ever sees half a picture.
Result<void> write_png(const std::filesystem::path& file, const Image& image);

}  // namespace weft
