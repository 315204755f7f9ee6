// The checkpoint of a long run, from which the same command goes on after a kill: a snapshot with the run's own counts in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "engine/simulation.h"
#include "samples/weft/report.h"

namespace weft::command {

/// How far a run is, and what it has counted.
struct Tally {
  std::uint32_t frames = 0;
  double clamped = 0;                          // s
  std::optional<Intersections> intersections;  // none unless they are counted
};

Result<void> write_checkpoint(const std::filesystem::path& file, const Simulation& simulation, const Tally& tally);

struct Checkpoint {
  Snapshot snapshot;
  Tally tally;
};

/// One that the simulation can be put back to. Errors: it cannot be read; it is of another scene; it does not say whether cloth
/// crossed where `checked`.
Result<Checkpoint> load_checkpoint(const std::filesystem::path& file, const Simulation& simulation, bool checked);

}  // namespace weft::command
