// Graph colouring for Gauss-Seidel: no two links of a colour share a particle, so all links of a colour can be solved in parallel
// (gauss_seidel.comp).
//
// Greedy colouring in the links' order: each takes the lowest colour that neither of its ends has yet. A particle in n links
// needs n colours; greedy takes at most 2 n - 1, and on grids one or two more than n. Far links come first, so that a sweep
// ends with the edges.
#include <algorithm>

#include "engine/cook/parts.h"

namespace weft::cooking {
namespace {

// The colours of a particle's links.
class Palette {
 public:
  bool has(std::uint32_t colour) const { return colour < taken_.size() && taken_[colour]; }
  void take(std::uint32_t colour) {
    if (taken_.size() <= colour) taken_.resize(colour + 1);
    taken_[colour] = true;
  }

 private:
  std::vector<bool> taken_;
};

}  // namespace

void colour_links(CookedFabric& fabric) {
  std::vector<Palette> palettes(fabric.positions.size());
  std::vector<std::vector<gpu::uvec4>> colours;
  const auto colour = [&](const StretchLink& link) {
    if (fabric.positions[link.a].w == 0 && fabric.positions[link.b].w == 0) return;
    std::uint32_t lowest = 0;
    while (palettes[link.a].has(lowest) || palettes[link.b].has(lowest)) ++lowest;
    palettes[link.a].take(lowest);
    palettes[link.b].take(lowest);
    if (colours.size() <= lowest) colours.resize(lowest + 1);
    colours[lowest].push_back(gpu::pack_coloured({link.a, link.b, link.rest, link.compliance, link.only_pulls}));
  };
  for (const bool pulls : {true, false})
    for (const StretchLink& link : fabric.links)
      if (link.only_pulls == pulls) colour(link);
  for (auto& links : colours) {
    // Neighbours in the cloth are neighbours in memory.
    std::stable_sort(links.begin(), links.end(),
                     [](const gpu::uvec4& x, const gpu::uvec4& y) { return std::min(x.x, x.y) < std::min(y.x, y.y); });
    fabric.coloured_links.insert(fabric.coloured_links.end(), links.begin(), links.end());
    fabric.colour_ends.push_back(static_cast<std::uint32_t>(fabric.coloured_links.size()));
  }
}

}  // namespace weft::cooking
