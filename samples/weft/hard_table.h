// The hard cases as a table: on the screen while they run, as CSV, and as the README has it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "samples/weft/hard_run.h"

namespace weft::command {

struct HardRow {
  std::string name, families, what, unit, scene;
  double bound = 0, measured = 0;   // an infinite bound: published only
  bool held() const { return measured <= bound; }
};

/// Runs the cases whose scenes are in a folder, prints each figure, and puts the scene `invariance` through every perturbation; `quick`:
/// without the large ones and with a few perturbations; `only`: those whose name has this part. Stops early when interrupted.
Result<std::vector<HardRow>> run_suite(const compute::Device& device, const std::filesystem::path& scenes, bool quick,
                                       std::string_view only);

std::string csv(const std::vector<HardRow>& rows);

/// A line a figure, but for those that have to be 0 and are: they are counted, and cases that have no other are named.
std::string markdown(const std::vector<HardRow>& rows, bool whole);

/// The file, if there is a place for the table in it.
Result<std::string> marked_text(const std::filesystem::path& file);

/// Replaces what stands between the two marks in a file. Errors: no file, no marks.
Result<void> replace_table(const std::filesystem::path& file, const std::string& table);

}  // namespace weft::command
