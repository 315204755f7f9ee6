// Inertia in moving frames: how much cloth feels of the motion of a character, or of whatever else it goes with.
#pragma once

#include <array>

#include "engine/effects/buffer.h"
#include "engine/moving_frame.h"

namespace weft {

/// What a moving frame did in the last frame of the simulation.
struct FrameMotion {
  std::array<double, 3> velocity{};   // m/s, of its place
  Rotation turn;
  double seconds = 1;                 // that it took
};

/// From one pose to the next.
FrameMotion motion_between(const MovingFrame& from, const MovingFrame& to, double seconds);

/// What the velocities of a cloth's particles become where a frame at `at` did `before` and will do `next`.
gpu::FrameChange change_of(const Inertia& inertia, const MovingFrame& at, const FrameMotion& before, const FrameMotion& next);

/// The joints that cloths go with, an entry a cloth: of SkinLists' joints; kNone: the host moves the frame.
struct InertiaLists {
  std::vector<std::uint32_t> joints;
  std::vector<Vec3> places;           // m: where the joint is at rest
};

namespace buffers {
/// Of each cloth, for the frame; zero: nothing is taken out.
inline constexpr Buffer frame_changes = buffer<gpu::FrameChange>("frame_changes", Lifetime::uploaded, [](const Cooked& s) {
  return std::uint64_t(s.scene.cloths.size());
});
}  // namespace buffers

}  // namespace weft
