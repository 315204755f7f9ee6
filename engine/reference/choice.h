// "solver": {"method": "auto", "budget_ms": 2}: chooses settings from a measured accuracy curve.
//
// A curve has milliseconds and strain of settings at a few resolutions. At another number of particles both are interpolated
// between the nearest two, as power laws; beyond the largest, milliseconds grow with the particles and the strain stays;
// below the smallest, both stay. The setting with the least strain among those that fit is taken, the cheapest where none
// does; plain averaging never, because it does not conserve momentum.
//
// Limitations: a curve is measured on one scene at one frame rate; the cost of contacts and colliders is not in it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "compute/result.h"
#include "engine/reference/curve.h"
#include "engine/scene.h"

namespace weft {

struct Choice {
  CurvePoint setting;      // row, assignments, substeps and iterations; milliseconds and strain as expected here
  bool fits = true;        // false: even this one, the cheapest, exceeds the budget
};

/// Among the points for which `goes` holds. Errors: a curve without one that counts.
Result<Choice> choose(const Curve& curve, double budget_ms, std::uint64_t particles, bool tethers,
                      const std::function<bool(const CurvePoint&)>& goes = [](const CurvePoint&) { return true; });

/// The scene with the settings that its budget buys in place of "auto", among those that go with what the scene has; `note` says which, and
/// from which curve. Any other scene comes back as it is. Errors: those of choose; an assignment in the curve that no scene knows.
Result<Scene> with_choice(const Scene& scene, std::uint64_t particles, const Curve& curve, std::string& note);

/// Measured on the software driver, for devices without a curve of their own. choice_table.cpp names the command.
Curve builtin_curve();

/// The part of a curve that choose needs: milliseconds and rms strain of the settings on the front of some resolution.
Curve condensed(const Curve& curve);

}  // namespace weft
