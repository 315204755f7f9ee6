// What no shader may see of what a host says: numbers that are not finite, or too large for floats to square.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/fabric.h"

namespace weft {

/// m, m/s, m/s^2: what reaches this far counts as not finite. Its square still adds up in floats (update_velocity.glsl).
inline constexpr float kFarthest = 1e10f;

inline bool is_finite(Vec3 v) { return dot(v, v) < kFarthest * kFarthest; }
inline bool is_finite(const gpu::vec4& v) { return is_finite(Vec3{v.x, v.y, v.z}); }

/// A particle whose wanted place is not finite keeps the present one, moved on as its neighbours across triangles are, so that nothing
/// tears at it where a whole cloth is carried off. `mended` says which they were.
void sanitize_positions(const CookedFabric& fabric, const std::vector<gpu::vec4>& present, std::vector<gpu::vec4>& wanted, std::vector<bool>& mended);

/// The first number in a scene that is not finite and should be, or vector that reaches kFarthest, with its JSON path, as a sentence; empty if there is none. The reader lets
/// none through; a program that makes its own scene might.
std::string non_finite_fault(const Scene& scene);

}  // namespace weft
