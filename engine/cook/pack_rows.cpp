// Rows of a sparse list, packed for gathers: two entries a fetch.
#include <algorithm>

#include "engine/cook/parts.h"

namespace weft::cooking {

PairRows pack_rows(std::span<const std::vector<gpu::uvec2>> lists, Padding padding, double most_padding) {
  PairRows packed;
  packed.rows.reserve(lists.size());
  std::size_t longest = 0, total = 0;
  for (const auto& list : lists) {
    longest = std::max(longest, (list.size() + 1) / 2);
    total += (list.size() + 1) / 2;
  }
  const bool even = static_cast<double>(longest * lists.size()) <= (1 + most_padding) * static_cast<double>(total);
  if (most_padding > 0 && even) packed.stride = static_cast<std::uint32_t>(longest);
  for (std::uint32_t owner = 0; owner < lists.size(); ++owner) {
    const auto& list = lists[owner];
    packed.rows.push_back({static_cast<std::uint32_t>(packed.pairs.size()), static_cast<std::uint32_t>(list.size())});
    for (std::size_t k = 0; k < list.size(); k += 2) {
      const gpu::uvec2 second = k + 1 < list.size() ? list[k + 1] : gpu::uvec2{padding == Padding::owner ? owner : list[k].x, 0};
      packed.pairs.push_back({list[k].x, list[k].y, second.x, second.y});
    }
    if (packed.stride > 0) packed.pairs.resize(std::size_t(owner + 1) * packed.stride, {owner, 0, owner, 0});
  }
  return packed;
}

}  // namespace weft::cooking
