// Distance constraints, solved by Gauss-Seidel in the order of their colours.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

namespace lengths {
inline std::uint64_t coloured_links(const Cooked& s) { return s.fabric.coloured_links.size(); }
}  // namespace lengths

namespace buffers {
/// Colour after colour (pack_coloured). None where all particles are held.
inline constexpr Buffer coloured_links = cooked<gpu::uvec4, &CookedFabric::coloured_links>("coloured_links");
/// Bits of their multipliers.
inline constexpr Buffer coloured_lambda = scratch<gpu::uint>("coloured_lambda", lengths::coloured_links);
}  // namespace buffers
}  // namespace weft
