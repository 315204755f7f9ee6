// What each command that takes --shard makes of its rows, for `weft merge`.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "samples/weft/shard.h"

namespace weft::command {

struct Mergeable {
  std::string command;              // as in Work
  std::vector<std::string> files;   // that conclude writes
  std::function<Exit(const Rows& all, const std::filesystem::path& out)> conclude;   // prints the rows, too
};

Mergeable merged_accuracy();
Mergeable merged_contacts();
Mergeable merged_effects();
Mergeable merged_family();
Mergeable merged_hard_cases();
Mergeable merged_harden();
Mergeable merged_implicit();

}  // namespace weft::command
