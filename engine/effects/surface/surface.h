// What the renderer draws: positions and normals of render vertices.
#pragma once

#include "engine/effects/buffer.h"

namespace weft::buffers {

namespace detail {
constexpr Buffer drawn(std::string_view name) {
  Buffer row = scratch<gpu::vec4>(name, lengths::vertices);
  row.access = Access::vertices;
  return row;
}
}  // namespace detail

/// Of each render vertex: particle, first corner, number of corners, unused.
inline constexpr Buffer surface_rows = cooked<gpu::uvec4, &CookedFabric::surface_rows>("surface_rows");
/// The two other particles of a corner's triangle, in order.
inline constexpr Buffer corners = cooked<gpu::uvec2, &CookedFabric::corners>("corners");
/// For the renderer: xyz, 1 and xyz, 0.
inline constexpr Buffer vertex_positions = detail::drawn("vertex_positions");
inline constexpr Buffer vertex_normals = detail::drawn("vertex_normals");

}  // namespace weft::buffers
