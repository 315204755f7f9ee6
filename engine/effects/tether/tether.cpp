// How long tethers are. A tether as long as the way along the unstretched cloth makes cloth stiffer than its moduli say: between two
// corners at their full distance it holds the top edge straight, and the sheet hangs as a board. So each is longer by the strain that
// the fabric's own weight causes. A line held at both ends at its full length, of stiffness Y and weight q a length (both per width),
// sags until its tension carries its weight: q L^2 / (8 f) = Y e with the sag f, and e = 8 f^2 / (3 L^2). So
//     e = (q L / Y)^(2/3) / (24^(1/3)).
// L is the cloth's longest way to an anchor; Y is that of the tether's direction (engine/effects/stretch/links.cpp), so that
// tethers askew to the threads, where woven cloth shears, give way most.
#include "engine/effects/tether/tether.h"

#include <algorithm>
#include <cmath>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::tethers};

constexpr double kMostSlack = 1;

// Of a tether whose way is askew to the threads (AnchorDistance). A rigid fabric has none; springs in place of the fabric say nothing
// of directions.
double slack(const Cloth& cloth, double gravity, double longest, double askew) {
  if (cloth.tether_slack) return *cloth.tether_slack;
  if (cloth.springs) return 0;
  const Fabric& fabric = cloth.fabric;
  const double compliance = (1 - 2 * askew) / fabric.stretch + askew / fabric.shear;
  return std::min(kMostSlack, std::pow(fabric.area_density * gravity * longest * compliance, 2.0 / 3) / std::cbrt(24));
}

// Of the cloth's figures where maps make it heaviest and softest.
Cloth at_its_weakest(const Cloth& cloth, const Mesh& mesh) {
  Cloth weakest = cloth;
  const auto factors = cooking::factors_of(cloth.maps, mesh);
  if (!factors) return weakest;
  const auto extreme = [](const std::vector<float>& of, auto which) { return of.empty() ? 1.0 : double(*which(of)); };
  weakest.fabric.area_density *= extreme(factors->mass, [](const auto& of) { return std::ranges::max_element(of); });
  const double softest = std::max(1e-6, extreme(factors->stretch, [](const auto& of) { return std::ranges::min_element(of); }));
  weakest.fabric.stretch *= softest;
  weakest.fabric.shear *= softest;
  return weakest;
}

// Adds the tethers of a cloth that is held at these points; returns how many of its particles have none.
std::uint32_t add_tethers(cooking::CookState& state, const Cloth& described, const Mesh& mesh, std::span<const std::uint32_t> particle_of,
                          const std::vector<std::uint32_t>& points) {
  const CookedFabric& fabric = state.fabric();
  const Cloth cloth = at_its_weakest(described, mesh);
  const auto reaches = cooking::nearest_anchors(mesh, points, cloth.tethers_per_vertex);
  const double gravity = length(state.scene().gravity);
  double longest = 0;
  for (const auto& list : reaches)
    for (const auto& reach : list) longest = std::max(longest, reach.distance);
  std::uint32_t unreached = 0;
  state.tethers.resize(fabric.positions.size());
  for (std::uint32_t point = 0; point < reaches.size(); ++point) {
    if (fabric.positions[particle_of[point]].w == 0) continue;
    unreached += reaches[point].empty();
    for (const auto& [anchor, distance, askew] : reaches[point])
      state.tethers[particle_of[point]].push_back(
          {particle_of[points[anchor]], static_cast<float>(distance * (1 + slack(cloth, gravity, longest, askew)))});
  }
  return unreached;
}

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  if (!input.cloth.tethers || input.anchors.empty()) return {};
  std::vector<std::uint32_t> points;
  for (const auto& anchor : input.anchors) points.push_back(anchor.point);
  const std::uint32_t unreached = add_tethers(state, input.cloth, input.mesh, state.particle_of(), points);
  if (unreached > 0) state.note(input.cloth, unreached, " particles are connected to no anchor and have no tether");
  return {};
}

// How many a particle has places for.
std::size_t places(cooking::CookState& state) {
  std::size_t longest = 0;
  for (const auto& list : state.tethers) longest = std::max(longest, list.size());
  if (state.may_pin())
    for (const Cloth& cloth : state.scene().cloths)
      if (cloth.tethers) longest = std::max<std::size_t>(longest, cloth.tethers_per_vertex);
  // Torn cloth has fewer, and may have more again where a snapshot makes it whole.
  for (const ClothRange& range : state.fabric().cloths) {
    const Cloth& cloth = state.scene().cloths[static_cast<std::size_t>(&range - state.fabric().cloths.data())];
    if (cloth.tear && cloth.tethers) longest = std::max<std::size_t>(longest, std::min(cloth.tethers_per_vertex, range.anchors));
  }
  return longest + longest % 2;   // two a fetch
}

void lay_out(cooking::CookState& state) {
  CookedFabric& fabric = state.fabric();
  const std::size_t longest = places(state);
  fabric.tethers.clear();
  fabric.tether_count = 0;
  fabric.tethers_per_particle = static_cast<std::uint32_t>(longest);
  if (longest == 0) return;
  state.tethers.resize(fabric.positions.size());
  for (const auto& list : state.tethers) {
    fabric.tether_count += list.size();
    for (std::size_t k = 0; k < longest; ++k) fabric.tethers.push_back(k < list.size() ? list[k] : gpu::Tether{WEFT_NONE, 0});
  }
}

void hold(cooking::CookState& state, std::span<const Mesh> meshes) {
  const CookedFabric& fabric = state.fabric();
  for (std::size_t c = 0; c < fabric.cloths.size(); ++c) {
    const Cloth& cloth = state.scene().cloths[c];
    if (!cloth.tethers) continue;
    const std::vector<std::uint32_t> particle_of = cooking::particles_of(fabric, fabric.cloths[c], meshes[c]);
    std::vector<std::uint32_t> points;
    for (std::uint32_t p = 0; p < particle_of.size(); ++p)
      if (fabric.positions[particle_of[p]].w == 0) points.push_back(p);
    if (!points.empty()) add_tethers(state, cloth, meshes[c], particle_of, points);
  }
  lay_out(state);
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
    .hold = hold,
};

}  // namespace weft::effects
