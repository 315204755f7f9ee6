// Files that are there whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "compute/result.h"

namespace weft::command {

/// Writes under a temporary name in the same folder and renames.
Result<void> write_text(const std::filesystem::path& file, std::string_view text);

/// Makes the folder and those above it.
Result<void> make_folder(const std::filesystem::path& folder);
/// False where that cannot be found out: no permission, or a path that is too long.
bool is_folder(const std::filesystem::path& path);
bool is_there(const std::filesystem::path& path);

/// Where `weft accuracy --save` saves a device's curve, and "method": "auto" looks for it; empty where no home is known.
std::filesystem::path curve_file(std::string_view device);

/// Where compiled pipelines are saved between runs; empty where no home is known.
std::filesystem::path pipeline_cache();

/// `name` without what a file's name cannot hold.
std::string file_name(std::string_view name);

}  // namespace weft::command
