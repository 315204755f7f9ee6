// Motion constraints: particles stay near their animated places, and in front of backstops.
#pragma once

#include "engine/effects/buffer.h"

namespace weft {

std::vector<gpu::MotionLimits> motion_limits_of(const Scene& scene);

/// Whether any cloth has backstops.
bool has_backstops(const Scene& scene);

/// Those of particles without any.
std::vector<gpu::vec4> no_motion_targets(const CookedFabric& fabric);

namespace lengths {
inline std::uint64_t cloth_particles(const Cooked& s) { return weft::cloth_particles(s.fabric); }
inline std::uint64_t motion_targets(const Cooked& s) { return 4 * cloth_particles(s); }
inline std::uint64_t cloths(const Cooked& s) { return s.scene.cloths.size(); }
}  // namespace lengths

namespace buffers {
/// Four a particle of cloth. xyz the animated place where the frame begins, w its max distance; xyz that where the frame ends, w the
/// stiffness; xyz the backstop's centre where the frame begins, w its radius; xyz that where the frame ends (m).
inline constexpr Buffer motion_targets = buffer<gpu::vec4>("motion_targets", Lifetime::scratch, lengths::motion_targets,
                                                           [](const Cooked& s) { return made(no_motion_targets(s.fabric)); });
/// Of each cloth, for the frame.
inline constexpr Buffer motion_limits = buffer<gpu::MotionLimits>("motion_limits", Lifetime::uploaded, lengths::cloths);
}  // namespace buffers

}  // namespace weft
