// Files that are there whole or not at all: everything that Weft writes goes through here.
//
// The bytes go into a new file beside the target, which takes the target's name only when all of them are written. A full disk or a kill
// leaves what was there before, or nothing, but never half of something. (A kill may leave the new file, NAME.*.part.)
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "compute/result.h"

namespace weft {

/// Replaces `file`, or makes it; its folder must exist. Two programs that write the same file at once each write all of it, and
/// the last one wins. Errors, after which nothing of it is left: the system's reason, as "No space left on device"; a target that
/// is there and no regular file.
Result<void> write_file(const std::filesystem::path& file, std::span<const std::byte> bytes);

}  // namespace weft
