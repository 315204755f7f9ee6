// Springs of the methods mass_spring, verlet and implicit.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

namespace lengths {
inline std::uint64_t spring_places(const Cooked& s) { return 4 * s.fabric.spring_rows.ends.size(); }
}  // namespace lengths

namespace buffers {
/// Of each particle: first group of four springs, number of groups.
inline constexpr Buffer spring_rows = cooked<gpu::uvec2, &CookedFabric::spring_rows, &SpringRows::rows>("spring_rows");
/// The other ends of four springs; the particle's own number in unused places.
inline constexpr Buffer spring_ends = cooked<gpu::uvec4, &CookedFabric::spring_rows, &SpringRows::ends>("spring_ends");
/// Rest length (m), stiffness (N/m), damping (N s/m), 1 if it only pulls.
inline constexpr Buffer springs = cooked<gpu::vec4, &CookedFabric::spring_rows, &SpringRows::springs>("springs");
}  // namespace buffers
}  // namespace weft
