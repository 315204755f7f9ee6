// A movie of pictures that are there already, by the program ffmpeg.
#pragma once

#include <filesystem>
#include <span>

#include "compute/result.h"

namespace weft::command {

/// Whether PATH has it.
bool has_ffmpeg();

/// An MP4 of PNGs of one size, in this order, `rate` a second. Errors: a picture that cannot be read; an ffmpeg that does not start or that
/// fails; nothing is left of the movie then.
Result<void> write_movie(const std::filesystem::path& file, std::span<const std::filesystem::path> pictures, double rate);

}  // namespace weft::command
