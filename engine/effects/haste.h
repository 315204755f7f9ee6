// How often links are swept through where anchors are hasty.
//
// A sweep carries a pull a few links far. Where anchors come along by a fair part of a link in a substep, cloth behind them has to follow
// at once; coarse levels see nothing of it, whose links are longer than the bend is wide. A cape of 32 x 48 that is pulled along at 5 m/s
// strained by 17 % without contacts and by 18 % with them, and does by 8.2 and 8.5 % (LevelCase.a_cape_that_is_moved_fast*).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/effects/effect.h"

namespace weft {

inline constexpr float kHastePerSweep = 0.05f;   // of a link's length that an anchor goes in a substep
inline constexpr float kMostSweeps = 5;

/// `haste`: FrameInput::haste. Who asks for more iterations has them, in every substep, with multipliers that they keep.
inline std::uint32_t sweeps_in_haste(const Needs& needs, float haste) {
  if (needs.constants[gpu::constant::is_iterated] != 0) return 1;
  return static_cast<std::uint32_t>(std::clamp(std::ceil(haste / kHastePerSweep), 1.0f, kMostSweeps));
}

}  // namespace weft
