// Distance constraints between neighbours, solved by Jacobi iteration.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

namespace lengths {
inline std::uint64_t link_pairs(const Cooked& s) { return s.fabric.stretch.pairs.size(); }
}  // namespace lengths

namespace buffers {
/// Of each particle: first pair of links, number of links.
inline constexpr Buffer stretch_rows = cooked<gpu::uvec2, &CookedFabric::stretch, &PairRows::rows>("stretch_rows");
/// Two links (pack_link).
inline constexpr Buffer stretch_links = cooked<gpu::uvec4, &CookedFabric::stretch, &PairRows::pairs>("stretch_links");
/// Multipliers of both links (kg m).
inline constexpr Buffer stretch_lambda = scratch<gpu::vec2>("stretch_lambda", lengths::link_pairs);
}  // namespace buffers
}  // namespace weft
