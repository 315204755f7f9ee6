#include "compute/contraction.h"

#include <algorithm>
#include <set>

#include "compute/spirv.h"

namespace weft::compute {

std::vector<uint32_t> without_contraction(std::span<const uint32_t> spirv) {
  using namespace spirv;
  std::vector<uint32_t> decorations;
  std::set<uint32_t> decorated;
  size_t annotations = 0;   // where they begin
  for (size_t at = kHeaderWords; at < spirv.size() && spirv[at] >> 16 != 0; at += spirv[at] >> 16) {
    const auto words = spirv.subspan(at, std::min<size_t>(spirv[at] >> 16, spirv.size() - at));
    const uint32_t op = words[0] & 0xffff;
    if (op == OpDecorate && annotations == 0) annotations = at;
    if (op == OpDecorate && words.size() > 2 && words[2] == kNoContraction) decorated.insert(words[1]);
    if (op >= kFirstArithmetic && op <= kLastArithmetic && words.size() > 2 && decorated.insert(words[2]).second)
      decorations.insert(decorations.end(), {3u << 16 | OpDecorate, words[2], kNoContraction});
  }
  std::vector<uint32_t> result(spirv.begin(), spirv.end());
  if (annotations > 0) result.insert(result.begin() + static_cast<std::ptrdiff_t>(annotations), decorations.begin(), decorations.end());
  return result;
}

}  // namespace weft::compute
