// Contacts: cloth against cloth, itself included, and against mesh colliders.
#pragma once

#include <bit>

#include "engine/effects/buffer.h"

namespace weft {

/// What contact passes are told: from the scene's settings, or from the mean edge and the thickness where those say 0. All 0 without contacts.
gpu::ContactSettings contact_settings(const Scene& scene, const CookedFabric& fabric);

namespace lengths {
inline std::uint64_t triangles(const Cooked& s) { return s.fabric.triangles.size(); }
inline std::uint64_t edges(const Cooked& s) { return s.fabric.edges.size(); }
inline std::uint64_t primitives(const Cooked& s) { return triangles(s) + edges(s); }
inline std::uint64_t slots(const Cooked& s) { return s.contacts.slots; }
}  // namespace lengths

namespace buffers {

// ---- what is cooked

/// Three particles, unused: of cloths and of mesh colliders.
inline constexpr Buffer triangles = buffer<gpu::uvec4>("triangles", Lifetime::cooked, lengths::triangles, [](const Cooked& s) {
  std::vector<gpu::uvec4> triangles;
  for (const auto& [a, b, c] : s.fabric.triangles) triangles.push_back({a, b, c, 0});
  return made(triangles);
});
/// Two particles: of those triangles, each once.
inline constexpr Buffer edges = cooked<gpu::uvec2, &CookedFabric::edges>("edges");
/// xyz rest position (m), w thickness (m).
inline constexpr Buffer rest = cooked<gpu::vec4, &CookedFabric::rest>("rest");

// ---- detection: what holds from one to the next

/// What detection and contacts tell each other.
inline constexpr Buffer detection = [] {
  Buffer row = buffer<gpu::Detection>("detection", Lifetime::kept, lengths::one, [](const Cooked&) {
    std::vector<gpu::Detection> detection(1);
    detection[0].due = 1;
    return made(detection);
  });
  row.access = Access::arguments;
  return row;
}();
/// xyz position at the last detection (m), w unused.
inline constexpr Buffer references = buffer<gpu::vec4>("references", Lifetime::kept, lengths::particles);
/// xyz what it would go from there in Detection::horizon substeps (m), w unused.
inline constexpr Buffer paths = buffer<gpu::vec4>("paths", Lifetime::kept, lengths::particles);
/// How far it may stray from that path: a float's bits (m); 0: held.
inline constexpr Buffer leashes = buffer<gpu::uint>("leashes", Lifetime::kept, lengths::particles);
/// Pairs that may meet before the next detection (pack_candidate).
inline constexpr Buffer candidates = growing(buffer<gpu::uvec4>("candidates", Lifetime::kept, lengths::candidates));

// ---- the grid

/// Entries of each slot.
inline constexpr Buffer grid_counts = cleared<gpu::uint>("grid_counts", lengths::slots);
/// First entry of each slot, and the end of the last.
inline constexpr Buffer grid_starts = scratch<gpu::uint>("grid_starts", [](const Cooked& s) { return lengths::slots(s) + 1; });
/// Entries of a workgroup's slots: at least 8.
inline constexpr Buffer grid_totals = scratch<gpu::uint>("grid_totals", [](const Cooked& s) { return lengths::slots(s) / 8 + 1; });
/// Three a primitive: xyz middle of its box (m), w bits: level << 28, and triangle or triangles + edge; xyz half sides, w away; xyz path, w step: its
/// Outline (primitive.glsl).
inline constexpr Buffer grid_entries = scratch<gpu::vec4>("grid_entries", [](const Cooked& s) { return 3 * lengths::primitives(s); });

// ---- contacts

/// xyz from side B to side A; w: the opposite of the height of the first particle over the middle (m), above 0 where the pair touches.
inline constexpr Buffer contact_normals = growing(scratch<gpu::vec4>("contact_normals", lengths::candidates));
/// Barycentric: side A's above 0 and side B's below.
inline constexpr Buffer contact_weights = growing(scratch<gpu::vec4>("contact_weights", lengths::candidates));
/// Pairs that a search found near each other, two in the place of each candidate: two edges; a particle and a triangle. They lie where the
/// contacts will be until those are prepared.
inline constexpr Buffer near_edges = [] {
  Buffer row = growing(scratch<gpu::uvec2>("near_edges", [](const Cooked& s) { return WEFT_NEAR * lengths::candidates(s); }));
  row.lies_in = &contact_normals;
  return row;
}();
inline constexpr Buffer near_faces = [] {
  Buffer row = growing(scratch<gpu::uvec2>("near_faces", [](const Cooked& s) { return WEFT_NEAR * lengths::candidates(s); }));
  row.lies_in = &contact_weights;
  return row;
}();
/// The candidates that touch, later those that could cross (contact_list.glsl).
inline constexpr Buffer contact_list = growing(scratch<gpu::uint>("contact_list", lengths::candidates));
/// Contacts of each particle in this substep.
inline constexpr Buffer contact_counts = cleared<gpu::uint>("contact_counts", lengths::particles);
/// xyz sum of corrections in units of `quantum`, w unused; 0 between iterations.
inline constexpr Buffer contact_sums = cleared<gpu::ivec4>("contact_sums", lengths::particles);
/// What a particle's contacts lack, together (contact_share.glsl); 0 between iterations.
inline constexpr Buffer contact_lacks = cleared<gpu::uint>("contact_lacks", lengths::particles);
/// Bits of the fraction of its way that a particle may go, a round each.
inline constexpr Buffer fractions =
    cleared<gpu::uvec4>("fractions", [](const Cooked& s) { return WEFT_ROUNDS / 4 * lengths::particles(s); }, std::bit_cast<std::uint32_t>(1.0f));

}  // namespace buffers
}  // namespace weft
