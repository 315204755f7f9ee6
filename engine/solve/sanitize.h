// State that a host writes, rid of what no shader may see (engine/finite.h).
#pragma once

#include <vector>

#include "engine/fabric.h"
#include "engine/finite.h"

namespace weft {

/// Replaces every wanted position that is not finite: by the present one, displaced by the mean of its neighbours across triangles.
/// A whole cloth that is moved far away therefore does not tear at such a particle. `sanitized` is true for those particles.
/// All lists have an entry for each particle (m).
void sanitize_positions(const CookedFabric& fabric, const std::vector<gpu::vec4>& present, std::vector<gpu::vec4>& wanted,
                        std::vector<bool>& sanitized);

}  // namespace weft
