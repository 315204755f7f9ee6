// From the edge of a patch of lost particles to its middle, a ring of neighbours a round.
#include "engine/solve/sanitize.h"

namespace weft {
namespace {

struct Motion {
  double x = 0, y = 0, z = 0;
  std::uint32_t count = 0;
};

}  // namespace

void sanitize_positions(const CookedFabric& fabric, const std::vector<gpu::vec4>& present, std::vector<gpu::vec4>& wanted, std::vector<bool>& mended) {
  std::vector<std::uint32_t> lost;
  mended.assign(wanted.size(), false);
  for (std::uint32_t i = 0; i < wanted.size(); ++i) {
    if (is_finite(wanted[i])) continue;
    mended[i] = true;
    lost.push_back(i);
    wanted[i] = present[i];
  }
  std::vector<bool> unknown = mended;
  while (!lost.empty()) {
    std::vector<Motion> motions(wanted.size());
    for (const Triangle& t : fabric.triangles)
      for (const std::uint32_t i : t)
        for (const std::uint32_t j : t)
          if (unknown[i] && !unknown[j])
            motions[i] = {motions[i].x + wanted[j].x - present[j].x, motions[i].y + wanted[j].y - present[j].y, motions[i].z + wanted[j].z - present[j].z, motions[i].count + 1};
    const std::size_t before = lost.size();
    std::erase_if(lost, [&](std::uint32_t i) {
      const Motion& m = motions[i];
      if (m.count == 0) return false;
      const auto moved = [&](float at, double sum) { return static_cast<float>(at + sum / m.count); };
      wanted[i] = {moved(present[i].x, m.x), moved(present[i].y, m.y), moved(present[i].z, m.z), wanted[i].w};
      unknown[i] = false;
      return true;
    });
    if (lost.size() == before) return;   // nobody near them is known: they stay
  }
}

}  // namespace weft
