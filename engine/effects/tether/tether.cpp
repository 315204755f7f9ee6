#include "engine/effects/tether/tether.h"

#include <algorithm>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::tethers};

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  if (!input.cloth.tethers || input.anchors.empty()) return {};
  const CookedFabric& fabric = state.fabric();
  const auto particle_of = state.particle_of();
  std::vector<std::uint32_t> points;
  for (const auto& anchor : input.anchors) points.push_back(anchor.point);
  const auto reaches = cooking::nearest_anchors(input.mesh, points, input.cloth.tethers_per_vertex);
  std::uint32_t unreached = 0;
  state.tethers.resize(fabric.positions.size());
  for (std::uint32_t point = 0; point < reaches.size(); ++point) {
    if (fabric.positions[particle_of[point]].w == 0) continue;
    unreached += reaches[point].empty();
    for (const auto& [anchor, distance] : reaches[point])
      state.tethers[particle_of[point]].push_back(
          {particle_of[points[anchor]], static_cast<float>(distance * (1 + input.cloth.tether_slack))});
  }
  if (unreached > 0) state.note(input.cloth, unreached, " particles are connected to no anchor and have no tether");
  return {};
}

void lay_out(cooking::CookState& state) {
  CookedFabric& fabric = state.fabric();
  std::size_t longest = 0;
  for (const auto& list : state.tethers) longest = std::max(longest, list.size());
  longest += longest % 2;   // two a fetch
  fabric.tethers_per_particle = static_cast<std::uint32_t>(longest);
  if (longest == 0) return;
  state.tethers.resize(fabric.positions.size());
  for (const auto& list : state.tethers) {
    fabric.tether_count += list.size();
    for (std::size_t k = 0; k < longest; ++k) fabric.tethers.push_back(k < list.size() ? list[k] : gpu::Tether{WEFT_NONE, 0});
  }
}

constexpr Figure kFigures[] = {{.name = "tethers", .cooked = [](const CookedFabric& f) { return f.tether_count; }}};

}  // namespace

constinit const Effect tether{
    .name = "tether",
    .called_for = [](const Scene&, const CookedFabric& fabric) { return !fabric.tethers.empty(); },
    .buffers = kBuffers,
    .part_of_finalize = "+tether",
    .specialize = [](const Cooked& s, Constants& constants) { constants[gpu::constant::tether_pairs] = s.fabric.tethers_per_particle / 2; },
    .reference = Reference::modelled,
    .figures = kFigures,
    .cook = cook,
    .lay_out = lay_out,
};

}  // namespace weft::effects
