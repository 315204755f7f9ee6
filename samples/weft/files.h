// Files that are there whole or not at all, and what tells their bytes apart.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "compute/file.h"

namespace weft::command {

/// As write_file.
Result<void> write_text(const std::filesystem::path& file, std::string_view text, Link link = Link::follow);

/// Makes the folder and those above it.
Result<void> make_folder(const std::filesystem::path& folder);
/// False where that cannot be found out: no permission, or a path that is too long.
bool is_folder(const std::filesystem::path& path);
bool is_there(const std::filesystem::path& path);

/// Where `weft accuracy --save` saves a device's curve, and "method": "auto" looks for it; empty where neither
/// XDG_CACHE_HOME nor HOME is an absolute path.
std::filesystem::path curve_file(std::string_view device);

/// Where compiled pipelines are saved between runs; empty as above.
std::filesystem::path pipeline_cache();

/// FNV-1a over bytes, to tell scenes and what was cooked from them apart; in 16 hexadecimal digits.
class Fingerprint {
 public:
  Fingerprint& add(const void* bytes, std::size_t count);
  Fingerprint& add(std::string_view text) { return add(text.data(), text.size()); }
  std::string text() const;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

/// `name` without what a file's name cannot hold.
std::string file_name(std::string_view name);

/// A field of a CSV file: text with a comma or a quotation mark is quoted, as RFC 4180 has it.
std::string quoted(std::string text);

}  // namespace weft::command
