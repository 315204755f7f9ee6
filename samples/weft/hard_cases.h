// The hard cases: what cloth simulations have failed at, each a scene and figures with bounds.
//
// A case is a scene file under assets/scenes/hard, how long it runs, and checks. A check looks at positions, velocities,
// rest lengths and what the engine counts, so any engine that plays the scenes can be given the same cases. `weft harden
// assets/scenes/hard` and tests/samples/hard_cases_test.cpp share this list, and the README's table is made from it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "engine/simulation.h"

namespace weft::command {

/// What a check may look at, after a frame.
struct Glance {
  const Scene& scene;
  const CookedFabric& fabric;
  std::span<const gpu::vec4> start, start_velocities;   // particles; w inverse mass of the former
  std::span<const gpu::vec4> positions, velocities;
  double time = 0;                                      // s, simulated
  double asked = 0, clamped = 0;                        // s: what the host asked for, and what of it was given back
  Counts counts;
};

enum class When { always, at_end };   // the largest of all frames, or that of the last

struct Check {
  std::string_view what;
  double bound;                       // the figure must not be above; infinite: published only
  std::string_view unit;
  When when;
  double (*figure)(const Glance&);
};

struct HardCase {
  std::string_view name;              // unique
  std::string_view families;          // numbered as in the README, and earlier systems' failures: "3 F1"
  std::string_view scene;             // assets/scenes/hard/SCENE.json
  double seconds;
  std::span<const Check> checks;
  std::uint32_t cells = 0;            // of the first cloth's grid, instead of the scene's
  double hitch = 0;                   // s: a frame that long halfway through
  bool large = false;                 // too large for CI: run by the command alone
};

std::span<const HardCase> hard_cases();

/// What a scene cannot show, or what is tested elsewhere in more ways than one scene shows: families and failures by the names of tests.
struct TestedBy {
  std::string_view family;            // one
  std::string_view test;              // suite.name
};
std::span<const TestedBy> tested_by();

}  // namespace weft::command
