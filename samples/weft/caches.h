// The caches of a run: what --cache asks for, written while it goes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/cache.h"
#include "engine/simulation.h"
#include "samples/weft/commands.h"
#include "samples/weft/outputs.h"

namespace weft::command {

class Caches {
 public:
  /// Before anything runs: whether there are such formats, and each can be written without going over what is read. Complains itself.
  static Exit prepare(const Scene& scene, const RunOptions& options, std::span<const Input> inputs);

  /// With the simulation as it is, after `resumed_at` frames or at its start. Complains itself.
  Exit open(const Simulation& simulation, const RunOptions& options, std::optional<std::uint32_t> resumed_at);
  /// The frame that the simulation has done.
  Result<void> add(const Simulation& simulation);
  /// They take their names; where the run was interrupted it is said what became of each instead.
  Result<void> finish();

  /// ", flag.pc2": for the sentence about what was written.
  std::string names() const;

 private:
  struct Cache {
    std::filesystem::path file;
    CachedShape shape;
    std::unique_ptr<CacheWriter> writer;
  };
  std::vector<Cache> caches_;
  std::uint32_t frames_ = 0;
  bool resumable_ = false;
};

}  // namespace weft::command
