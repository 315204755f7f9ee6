// The surface: triangles, and positions and normals of render vertices, for the renderer.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

namespace lengths {
inline std::uint64_t triangles(const Cooked& s) { return s.fabric.triangles.size(); }
}  // namespace lengths

namespace buffers {

namespace detail {
constexpr Buffer drawn(std::string_view name) {
  Buffer row = scratch<gpu::vec4>(name, [](const Cooked& s) { return std::uint64_t(drawn_vertices(s.fabric)); });
  row.access = Access::vertices;
  return row;
}
}  // namespace detail

/// Of each render vertex: particle, first corner, number of corners, unused.
inline constexpr Buffer surface_rows = cooked<gpu::uvec4, &CookedFabric::surface_rows>("surface_rows");
/// Triangles of cloths, then of mesh colliders: three particles, unused.
inline constexpr Buffer triangles = buffer<gpu::uvec4>("triangles", Lifetime::cooked, lengths::triangles, [](const Cooked& s) {
  std::vector<gpu::uvec4> triangles;
  for (const auto& [a, b, c] : s.fabric.triangles) triangles.push_back({a, b, c, 0});
  return made(triangles);
});
/// The two other particles of a corner's triangle, in its winding order.
inline constexpr Buffer corners = cooked<gpu::uvec2, &CookedFabric::corners>("corners");
/// For the renderer: xyz position (m), w 1; xyz unit normal, w 0.
inline constexpr Buffer vertex_positions = detail::drawn("vertex_positions");
inline constexpr Buffer vertex_normals = detail::drawn("vertex_normals");

}  // namespace buffers
}  // namespace weft
