// Pictures in memory and on disk: eight bits a channel, four channels, the first row on top.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "compute/result.h"

namespace weft {

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // 4 width height bytes
};

inline constexpr std::uint32_t kMostPixelsASide = 16384;
inline constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 26;   // 8192 x 8192: a quarter of a GiB

/// Reads a PNG or JPEG of at most kMostPixels. Errors: missing, unreadable or foreign file, one too large, a PNG that holds more than
/// the picture it announces, a JPEG of more than 100 scans: no file takes more memory than a picture of its size needs, or much longer.
Result<Image> read_image(const std::filesystem::path& file);

/// The same of a PNG or JPEG in memory, `name` in errors.
Result<Image> decode_image(std::string_view bytes, const std::string& name);

/// Writes under a temporary name and renames, so that nobody ever sees half a picture. Errors: a size of 0 or of other than 4 width height
/// bytes; a file that cannot be written.
Result<void> write_png(const std::filesystem::path& file, const Image& image);

}  // namespace weft
