// Chebyshev's semi-iteration over Jacobi's (Wang 2015).
#pragma once

#include "engine/effects/bend/bend.h"
#include "engine/effects/stretch/stretch.h"

namespace weft::buffers {

/// What both multipliers of a link pair, and the multiplier of a stencil, last changed by.
inline constexpr Buffer stretch_steps = scratch<gpu::vec2>("stretch_steps", lengths::link_pairs);
inline constexpr Buffer bend_steps = scratch<gpu::vec4>("bend_steps", lengths::bends);
/// Three a particle: the iterate before the last, the last (m), and the substep's first step (m).
inline constexpr Buffer iterates = buffer<gpu::vec4>("iterates", Lifetime::kept, [](const Cooked& s) { return 3 * lengths::particles(s); });
/// Whether the acceleration is steady.
inline constexpr Buffer acceleration = buffer<gpu::Acceleration>("acceleration", Lifetime::kept, lengths::one);

}  // namespace weft::buffers
