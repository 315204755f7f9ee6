// Bending about a flat shape: isometric stencils (Bergou et al. 2006), or a plate's second differences on a lattice of quads.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

namespace lengths {
inline std::uint64_t bends(const Cooked& s) { return s.fabric.bends.size(); }
}  // namespace lengths

namespace buffers {
/// Of each particle, its row of the bending matrix: first pair of entries, number of entries.
inline constexpr Buffer bend_rows = cooked<gpu::uvec2, &CookedFabric::bend, &PairRows::rows>("bend_rows");
/// (particle, coefficient as float bits) twice.
inline constexpr Buffer bend_entries = cooked<gpu::uvec4, &CookedFabric::bend, &PairRows::pairs>("bend_entries");
/// Stencils: lines and quads of a lattice, and inner edges where there is none.
inline constexpr Buffer bends = cooked<gpu::Bend, &CookedFabric::bends>("bends");
/// xyz multiplier of each stencil, and its last change (kg m).
inline constexpr Buffer bend_lambda = scratch<gpu::vec4>("bend_lambda", lengths::bends);
inline constexpr Buffer bend_impulses = scratch<gpu::vec4>("bend_impulses", lengths::bends);
/// (stencil, K times inverse mass as float bits) twice.
inline constexpr Buffer bend_uses = cooked<gpu::uvec4, &CookedFabric::bend_uses, &PairRows::pairs>("bend_uses");
/// Of each particle: first pair of uses, number of uses.
inline constexpr Buffer bend_use_rows = cooked<gpu::uvec2, &CookedFabric::bend_uses, &PairRows::rows>("bend_use_rows");
}  // namespace buffers
}  // namespace weft
