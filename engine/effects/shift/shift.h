// Shifts of rest lengths: links ask for what the sweeps of the frames before have left them short of (shaders/shift/shift.glsl).
#pragma once

#include <vector>

#include "engine/effects/effect.h"

namespace weft {

/// Links in the order of the lists that the solver reads: of patch_links, of strand_links, and of both links of each of stretch_links.
/// Entries: gpu::pack_shifted_link.
struct ShiftLists {
  std::vector<gpu::uvec4> patches, strands, stretch;
};

namespace lengths {
inline std::uint64_t shifted_patches(const Cooked& s) { return s.fabric.own.of<ShiftLists>().patches.size(); }
inline std::uint64_t shifted_strands(const Cooked& s) { return s.fabric.own.of<ShiftLists>().strands.size(); }
inline std::uint64_t shifted_stretch(const Cooked& s) { return s.fabric.own.of<ShiftLists>().stretch.size(); }
}  // namespace lengths

namespace buffers {
inline constexpr Buffer patch_shifted = own<gpu::uvec4, &ShiftLists::patches>("patch_shifted");
inline constexpr Buffer strand_shifted = own<gpu::uvec4, &ShiftLists::strands>("strand_shifted");
inline constexpr Buffer stretch_shifted = own<gpu::uvec4, &ShiftLists::stretch>("stretch_shifted");
/// By how much shorter a link is asked to be than it is at rest (m, a float's bits).
inline constexpr Buffer patch_shifts = buffer<gpu::uint>("patch_shifts", Lifetime::persistent, lengths::shifted_patches);
inline constexpr Buffer strand_shifts = buffer<gpu::uint>("strand_shifts", Lifetime::persistent, lengths::shifted_strands);
inline constexpr Buffer stretch_shifts = buffer<gpu::uint>("stretch_shifts", Lifetime::persistent, lengths::shifted_stretch);
}  // namespace buffers
}  // namespace weft
