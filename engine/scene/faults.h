// What is wrong with a scene, gathered while reading goes on, so that one run shows an author everything. Internal.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace weft {

class Faults {
 public:
  /// One sentence: `path: what`. An empty path is the scene itself.
  void add(std::string_view path, std::string_view what);

  bool empty() const { return count_ == 0; }
  std::size_t count() const { return count_; }

  /// One sentence a line. After the first kShown faults the last line says how many more there were.
  std::string text() const;

 private:
  static constexpr std::size_t kShown = 200;
  std::vector<std::string> lines_;
  std::size_t count_ = 0;
};

/// Text from outside, fit for a terminal: control characters become '?', and what is beyond `most` bytes becomes "...".
std::string printable(std::string_view text, std::size_t most = 60);

/// ` (did you mean "x"?)` for the name nearest by edit distance, or nothing when none is near.
std::string suggestion(std::string_view wrong, std::span<const std::string_view> names);

/// `"a", "b" or "c"`.
std::string either(std::span<const std::string_view> names);

}  // namespace weft
