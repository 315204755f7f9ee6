// What effects cost: frames of the base scene with them and without, in turns, and what they consist of.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compute/device.h"
#include "engine/scene.h"
#include "samples/weft/footprint.h"
#include "samples/weft/report.h"

namespace weft::command {

struct EffectPrice {
  std::string first, second;       // of effect_rows; second empty: the first alone
  std::string refused;             // why there is no such scene; empty where there is
  Footprint with;
  double dispatches = 0;           // a frame: the mean of those that were recorded
  Spread without_ms, with_ms;      // whole frames on the wall clock
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Footprint, passes, dispatches, bytes, instructions)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Spread, median, p95)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EffectPrice, first, second, refused, with, dispatches, without_ms, with_ms)

/// Steps a simulation of each scene, frame by frame in turns, so that whatever else the machine does slows both alike. The first frame of
/// each, in which the driver compiles, is not timed. Fewer frames if that is interrupted.
Result<EffectPrice> price_of(const compute::Device& device, const Scene& without, const Scene& with, std::uint32_t frames);

}  // namespace weft::command
