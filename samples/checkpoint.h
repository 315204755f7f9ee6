// What a long run leaves every so often, so that the same command can go on after a kill: a snapshot with the run's own counts in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "engine/simulation.h"
#include "samples/report.h"

namespace weft::command {

/// How far a run is, and what it has counted.
struct Tally {
  std::uint32_t frames = 0;
  double clamped = 0;                          // s
  std::optional<Intersections> intersections;  // none unless they are counted
};

Result<void> write_checkpoint(const std::filesystem::path& file, const Simulation& simulation, const Tally& tally);

/// Puts the simulation where the checkpoint was written. Errors: it cannot be read; it is of another scene; it does not say whether cloth
/// crossed where `checked`. The simulation is then as it was.
Result<Tally> resume(const std::filesystem::path& file, Simulation& simulation, bool checked);

}  // namespace weft::command
