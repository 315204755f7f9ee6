// What a simulation consists of on the device, whatever it does.
#pragma once

#include <cstdint>

#include "engine/simulation.h"

namespace weft::command {

struct Footprint {
  std::size_t passes = 0;
  std::uint64_t dispatches = 0;     // a frame that has them all
  std::uint64_t bytes = 0;          // of buffers
  std::uint64_t instructions = 0;   // of SPIR-V, of all specialised modules
  bool operator==(const Footprint&) const = default;
};

Footprint footprint_of(const Simulation& simulation);

}  // namespace weft::command
