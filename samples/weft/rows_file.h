// The file of a part's rows: lines of JSON, the first of which says what they are rows of, and the last is a fingerprint of all before it.
#pragma once

#include <string>
#include <string_view>

#include "samples/weft/shard.h"

namespace weft::command {

struct Part {
  Shard shard;
  std::string key;   // of the work and the program
  Rows content;
};

/// What parts have to have in common.
std::string key_of(const Work& work);

/// Numbers come back as the same bits, those that are not finite, too.
std::string text_of(const Part& part);
Result<Part> parse_part(std::string_view text);
Result<Part> load_part(const std::filesystem::path& file);

}  // namespace weft::command
