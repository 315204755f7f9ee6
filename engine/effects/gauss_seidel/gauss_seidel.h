// Distance constraints, solved by coloured Gauss-Seidel.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

namespace lengths {
inline std::uint64_t coloured_links(const Cooked& s) { return s.fabric.coloured_links.size(); }
}  // namespace lengths

namespace buffers {
/// Links, colour after colour (pack_coloured), without those between two held particles.
inline constexpr Buffer coloured_links = cooked<gpu::uvec4, &CookedFabric::coloured_links>("coloured_links");
/// Their multipliers, bits of floats (kg m).
inline constexpr Buffer coloured_lambda = scratch<gpu::uint>("coloured_lambda", lengths::coloured_links);
}  // namespace buffers
}  // namespace weft
