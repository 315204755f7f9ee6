// The ways to run a frame, for tests of what must be the same to the bit in each.
#pragma once

#include "compute/commands.h"
#include "tests/support/sheets.h"

namespace weft {

enum class Way { advance, submit, record };
inline constexpr Way kWays[] = {Way::advance, Way::submit, Way::record};

inline void run_frame(const compute::Device& device, Simulation& simulation, Way way, double seconds = kFrame) {
  if (way == Way::advance) must(simulation.advance(seconds));
  else if (way == Way::submit) must(simulation.submit(seconds));
  else must(compute::run_once(device, "host", [&](VkCommandBuffer commands) { must(simulation.record(commands, seconds)); }));
}

/// The same simulation, from its snapshot's bytes.
inline std::unique_ptr<Simulation> resumed(const compute::Device& device, const Simulation& simulation, const Scene& scene) {
  const auto bytes = snapshot_bytes(must(simulation.save()));
  auto other = must(Simulation::create(device, scene));
  must(other->restore(must(parse_snapshot(bytes))));
  return other;
}

}  // namespace weft
