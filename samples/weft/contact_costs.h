// What contacts cost in a scene, from timed frames: searches for pairs, and what is done with the pairs in every substep.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compute/device.h"
#include "engine/scene.h"

namespace weft::command {

struct PassCost {
  std::string name;
  double ms = 0;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PassCost, name, ms)

/// Times are of the frames after the first, in which the driver compiles.
struct ContactCosts {
  std::uint32_t vertices = 0;      // along one side of the grid
  double edge = 0, cell = 0;       // m: mean edge, and the grid's cell
  std::uint32_t substeps = 0;      // of all frames together
  std::uint32_t searches = 0;
  std::uint32_t pairs_most = 0, pairs_overflowed = 0;
  double solve = 0, search = 0, contacts = 0;   // ms a frame: everything else; searches; pairs found by them
  std::vector<PassCost> passes;    // of the fastest of several searches at the end of the run

  double per_search() const;       // ms; 0 without one
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ContactCosts, vertices, edge, cell, substeps, searches, pairs_most, pairs_overflowed, solve, search,
                                   contacts, passes)

/// Runs `frames` frames of a grid scene with `vertices` along a side and contacts on. `cell` (m): 0 for the automatic choice.
Result<ContactCosts> contact_costs(const compute::Device& device, const Scene& scene, std::uint32_t vertices, std::uint32_t frames,
                                   double cell);

/// The slope of log(ms a search) over log(vertices along a side), by least squares.
double growth(const std::vector<ContactCosts>& costs);

}  // namespace weft::command
