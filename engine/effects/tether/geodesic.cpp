// Geodesic rest distances to the nearest anchors. A tether that is too long lets the cloth stretch by as much; those behind a hole or a
// corner are slack, never too tight.
#include "engine/cook/parts.h"
#include "engine/mesh/geodesics.h"

namespace weft::cooking {
namespace {

// A wave ends where a vertex has enough nearer anchors, and beside that border distances propagate only along edges. Spare
// places a vertex move the border away from the anchors that are used.
constexpr std::uint32_t kSpare = 1;

}  // namespace

std::vector<std::vector<AnchorDistance>> nearest_anchors(const Mesh& mesh, std::span<const std::uint32_t> anchors, std::uint32_t count) {
  std::vector<std::vector<AnchorDistance>> nearest(mesh.points.size());
  if (count == 0) return nearest;
  const IntrinsicSurface surface = surface_of(mesh);
  Waves waves(surface, count + kSpare);
  for (const std::uint32_t anchor : anchors) waves.add(anchor);
  waves.run();
  for (std::uint32_t p = 0; p < nearest.size(); ++p)
    for (const Waves::Arrived& arrived : waves.at(p).first(std::min<std::size_t>(count, waves.at(p).size())))
      nearest[p].push_back({arrived.source, arrived.distance, arrived.along * (1 - arrived.along)});
  return nearest;
}

}  // namespace weft::cooking
