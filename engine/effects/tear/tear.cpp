#include "engine/effects/tear/tear.h"

#include <algorithm>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"

namespace weft {

bool tears(const Scene& scene) {
  return std::ranges::any_of(scene.cloths, [](const Cloth& cloth) { return cloth.tear.has_value(); });
}

std::uint64_t spare_points(const CookedFabric& fabric) {
  const auto& orders = fabric.own.of<TearLists>().orders;
  std::uint64_t spare = 0;
  for (std::size_t c = 0; c < orders.size(); ++c) spare += fabric.cloths[c].particles - orders[c].size();
  return spare;
}

void add_spares(const Scene& scene, std::span<Mesh> meshes) {
  for (std::size_t k = 0; k < std::min(scene.cloths.size(), meshes.size()); ++k) {
    const auto& tear = scene.cloths[k].tear;
    if (!tear || !check(meshes[k])) continue;   // cook says what is wrong with it
    const std::size_t points = meshes[k].points.size(), corners = 3 * meshes[k].triangles.size();
    const std::size_t wanted = tear->spare > 0 ? tear->spare : (points + 3) / 4;
    // When every corner is a point of its own there is nothing left to split.
    add_spares(meshes[k], static_cast<std::uint32_t>(std::min(wanted, corners - std::min(points, corners))));
  }
}

namespace effects {
namespace {

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  if (!tears(state.scene())) return {};
  TearLists& lists = state.fabric().own.of<TearLists>();
  auto& limits = lists.limits.emplace_back();
  if (!input.cloth.tear) return {};
  const auto factors = cooking::mapped("tear.map", input.cloth.tear->map, input.mesh);
  if (!factors) return factors.why();
  for (std::size_t p = 0; p < input.mesh.points.size(); ++p)
    limits.push_back(static_cast<float>(input.cloth.tear->strain * cooking::factor(*factors, p)));
  return {};
}

constexpr Figure kFigures[] = {
    {.name = "tear.splits", .counted = [](const Counts& c) { return std::uint64_t(c.splits); }},
    {.name = "tear.refused", .counted = [](const Counts& c) { return std::uint64_t(c.splits_refused); }},
};

void remark(const Counts& counts, std::vector<std::string>& remarks) {
  if (counts.splits > 0) remarks.push_back("Torn: " + std::to_string(counts.splits) + " vertices have become two");
  if (counts.splits_refused > 0)
    remarks.push_back(std::to_string(counts.splits_refused) + " times cloth could not tear: no spare vertices (its key \"tear.spare\") or no room");
}

}  // namespace

constinit const Effect tear{
    .name = "tear",
    .key = "tear",
    .called_for = [](const Scene& scene, const CookedFabric&) { return tears(scene); },
    .reference = Reference::absent,
    .figures = kFigures,
    .remark = remark,
    .cook = cook,
};

}  // namespace effects
}  // namespace weft
