// Files that are there whole or not at all: everything that Weft writes goes through here.
//
// The bytes go into a new file beside the target, which takes the target's name only when all of them are written. A full disk or a kill
// leaves what was there before, or nothing, but never half of something. (A kill may leave the new file, NAME.*.part.)
//
// Links: the file that a symbolic link leads to is replaced where the user named the place, and the link itself in Weft's caches, which
// it writes unasked. Of a file with several names (hard links) only the one that is written changes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "compute/result.h"

namespace weft {

/// A symbolic link in a file's place.
enum class Link {
  follow,   // stays, and what it leads to is replaced; one that leads nowhere is replaced itself
  replace   // is replaced itself, and what it leads to is not touched
};

/// Replaces `file`, or makes it; its folder must exist. Two programs that write the same file at once each write all of it, and
/// the last one wins. Errors, after which nothing of it is left: the system's reason, as "No space left on device"; a target that
/// is there and no regular file.
Result<void> write_file(const std::filesystem::path& file, std::span<const std::byte> bytes, Link link = Link::follow);

/// Finds out before long work whether write_file could write a page there now, and leaves nothing. Errors: as write_file's.
Result<void> probe_file(const std::filesystem::path& file, Link link = Link::follow);

/// The file whose name a finished one takes: `file`, or what a link in its place leads to. Errors: it is there and no regular file.
Result<std::filesystem::path> file_target(const std::filesystem::path& file, Link link = Link::follow);

}  // namespace weft
