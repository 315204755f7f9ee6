// Displacements spread from the edge of a patch of unknown particles to its middle, one ring of neighbours a round.
#include "engine/solve/sanitize.h"

namespace weft {
namespace {

struct Displacements {   // sum of `count` of them (m)
  double x = 0, y = 0, z = 0;
  std::uint32_t count = 0;
};

}  // namespace

void sanitize_positions(const CookedFabric& fabric, const std::vector<gpu::vec4>& present, std::vector<gpu::vec4>& wanted,
                        std::vector<bool>& sanitized) {
  std::vector<std::uint32_t> remaining;
  sanitized.assign(wanted.size(), false);
  for (std::uint32_t i = 0; i < wanted.size(); ++i) {
    if (is_finite(wanted[i])) continue;
    sanitized[i] = true;
    remaining.push_back(i);
    wanted[i] = present[i];
  }
  std::vector<bool> unknown = sanitized;
  while (!remaining.empty()) {
    std::vector<Displacements> sums(wanted.size());
    for (const Triangle& t : fabric.triangles)
      for (const std::uint32_t i : t)
        for (const std::uint32_t j : t)
          if (unknown[i] && !unknown[j])
            sums[i] = {sums[i].x + wanted[j].x - present[j].x, sums[i].y + wanted[j].y - present[j].y,
                       sums[i].z + wanted[j].z - present[j].z, sums[i].count + 1};
    const std::size_t before = remaining.size();
    std::erase_if(remaining, [&](std::uint32_t i) {
      const Displacements& m = sums[i];
      if (m.count == 0) return false;
      const auto moved = [&](float at, double sum) { return static_cast<float>(at + sum / m.count); };
      wanted[i] = {moved(present[i].x, m.x), moved(present[i].y, m.y), moved(present[i].z, m.z), wanted[i].w};
      unknown[i] = false;
      return true;
    });
    if (remaining.size() == before) return;   // they have no known neighbour: they stay
  }
}

}  // namespace weft
