// Untangling: cloth that goes through cloth is taken back. Part of contacts.
#pragma once

#include "engine/effects/contact/contact.h"

namespace weft::buffers {

/// The set of pairs of particles that are tangled (tangled.glsl).
inline constexpr Buffer tangled_pairs =
    scratch<gpu::uint>("tangled_pairs", [](const Cooked& s) { return std::uint64_t{s.contacts.tangled_room}; });
/// Of each edge: the triangle that it goes through first, WEFT_NONE if there is none, and the last one, or 1 << 31 where it goes through an
/// odd number.
inline constexpr Buffer crossed_triangles = scratch<gpu::uvec2>("crossed_triangles", lengths::edges);
/// The least number of a particle that each hangs together with by edges that contours do not cut.
inline constexpr Buffer regions = scratch<gpu::uint>("regions", lengths::particles);
/// How many there are, at that particle.
inline constexpr Buffer region_sizes = scratch<gpu::uint>("region_sizes", lengths::particles);

}  // namespace weft::buffers
