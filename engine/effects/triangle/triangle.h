// Triangles of cloth against spheres, capsules and boxes, where vertices alone would let these show through.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

struct TriangleLists {
  std::uint32_t most_around = 0;   // triangles around one particle; 0: vertices are enough
  bool with_round = false;         // with spheres and capsules, not only with boxes
  /// Of each collider of the scene, by how much its radius is larger to vertices, so that triangles between them stay out of it (m). Empty: none.
  std::vector<float> stand_offs = {};
};

namespace buffers {

/// How many triangles have met a collider in this substep, and which (triangle_search.comp).
inline constexpr Buffer collisions = [] {
  Buffer row = cleared<gpu::Collisions>("collisions", lengths::one);
  row.access = Access::arguments;
  return row;
}();
inline constexpr Buffer collision_list =
    scratch<gpu::uint>("collision_list", [](const Cooked& s) { return std::uint64_t(s.fabric.cloth_triangles); });
/// Two of each particle: what its triangles ask for, in quanta: out of colliders, w the sum of weights; and by friction,
/// w the last of the bodies that they met, with reactions.
inline constexpr Buffer collision_sums =
    cleared<gpu::ivec4>("collision_sums", [](const Cooked& s) { return std::uint64_t(2 * s.fabric.positions.size()); });
/// Of each particle: how far its triangles move it out of colliders that keep their size, whichever way, by the same weights and in the same
/// quanta.
inline constexpr Buffer collision_depths = cleared<int>("collision_depths", lengths::particles);

/// Of each particle, with contacts: the way out that its triangles asked for in this iteration (m).
inline constexpr Buffer ways_out = scratch<gpu::vec4>("ways_out", lengths::particles);

}  // namespace buffers
}  // namespace weft
