// What no shader may see of what a host says: numbers that are not finite, or too large for floats to square.
#pragma once

#include "engine/vector.h"
#include "shaders/shared.h"

namespace weft {

/// m, m/s, m/s^2: a vector of this length or more counts as not finite. Its square still adds up in floats (update_velocity.glsl).
inline constexpr float kTooLarge = 1e10f;

inline bool is_finite(Vec3 v) { return dot(v, v) < kTooLarge * kTooLarge; }
inline bool is_finite(const gpu::vec4& v) { return is_finite(Vec3{v.x, v.y, v.z}); }

}  // namespace weft
