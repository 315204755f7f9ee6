// The Chebyshev semi-iteration over Jacobi's (Golub and Varga 1961; Wang 2015).
#pragma once

#include "engine/effects/bend/bend.h"
#include "engine/effects/stretch/stretch.h"

namespace weft::buffers {

/// The last change of both multipliers of a link pair, and of a stencil's multiplier (kg m).
inline constexpr Buffer stretch_steps = scratch<gpu::vec2>("stretch_steps", lengths::link_pairs);
inline constexpr Buffer bend_steps = scratch<gpu::vec4>("bend_steps", lengths::bends);
/// Three a particle: xyz of the iterate before the last, of the last iterate, and of the substep's first step (m).
inline constexpr Buffer chebyshev_iterates =
    buffer<gpu::vec4>("chebyshev_iterates", Lifetime::persistent, [](const Cooked& s) { return 3 * lengths::particles(s); });
/// State of the guard that falls back to Jacobi when the acceleration diverges.
inline constexpr Buffer acceleration = buffer<gpu::Acceleration>("acceleration", Lifetime::persistent, lengths::one);

}  // namespace weft::buffers
