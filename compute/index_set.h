// A set of small whole numbers without a ceiling: of the buffers that a pass reads, or writes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace weft::compute {

class IndexSet {
 public:
  IndexSet() = default;
  IndexSet(std::initializer_list<std::size_t> indices) {
    for (const std::size_t index : indices) insert(index);
  }

  void insert(std::size_t index) {
    if (index / kBits >= words_.size()) words_.resize(index / kBits + 1);
    words_[index / kBits] |= std::uint64_t{1} << index % kBits;
  }
  void erase(std::size_t index) {
    if (contains(index)) words_[index / kBits] ^= std::uint64_t{1} << index % kBits;
  }
  bool contains(std::size_t index) const { return index / kBits < words_.size() && (words_[index / kBits] >> index % kBits & 1) != 0; }
  bool empty() const {
    return std::all_of(words_.begin(), words_.end(), [](std::uint64_t word) { return word == 0; });
  }
  /// Memory for numbers below `most`.
  void reserve(std::size_t most) { words_.reserve((most + kBits - 1) / kBits); }
  /// Keeps its memory.
  void clear() { std::fill(words_.begin(), words_.end(), 0); }

  bool intersects(const IndexSet& other) const {
    for (std::size_t k = 0; k < std::min(words_.size(), other.words_.size()); ++k)
      if ((words_[k] & other.words_[k]) != 0) return true;
    return false;
  }
  void insert(const IndexSet& other) {
    words_.resize(std::max(words_.size(), other.words_.size()));
    for (std::size_t k = 0; k < other.words_.size(); ++k) words_[k] |= other.words_[k];
  }
  bool operator==(const IndexSet& other) const {
    for (std::size_t k = 0; k < std::max(words_.size(), other.words_.size()); ++k)
      if ((k < words_.size() ? words_[k] : 0) != (k < other.words_.size() ? other.words_[k] : 0)) return false;
    return true;
  }

 private:
  static constexpr std::size_t kBits = 64;
  std::vector<std::uint64_t> words_;
};

}  // namespace weft::compute
