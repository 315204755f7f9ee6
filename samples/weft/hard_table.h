// The hard cases as a table: on the screen while they run, as CSV, and as the README has it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "samples/weft/hard_run.h"
#include "samples/weft/hardening.h"

namespace weft::command {

struct HardRow {
  std::string name, families, what, unit, scene;
  double bound = 0, measured = 0;   // an infinite bound: published only
  bool held() const { return measured <= bound; }
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HardRow, name, families, what, unit, scene, bound, measured)

/// A hard case, or a group of perturbations that the scene `invariance`, or its rigid twin, is put through.
struct SuiteItem {
  const HardCase* hard = nullptr;   // null: a group
  std::string group;
  std::string scene_file;           // without its ending
  Scene scene;
};

/// What there is to run of the scenes in a folder; `quick`: without the large ones and with a few perturbations; `only`: those whose name
/// has this part.
Result<std::vector<SuiteItem>> suite_of(const std::filesystem::path& scenes, bool quick, std::string_view only);

/// Runs items, those of one scene with one run of it as it is. Figures mean nothing after an interruption.
class SuiteRunner {
 public:
  SuiteRunner(const compute::Device& device, bool quick) : device_(device), quick_(quick) {}
  Result<std::vector<HardRow>> measure(const SuiteItem& item);

 private:
  Result<std::vector<HardRow>> measure_group(const SuiteItem& item);

  const compute::Device& device_;
  bool quick_;
  std::string base_of_;             // the scene that base_ is of
  std::optional<PerturbedRun> base_;
};

/// On the screen, while they are measured.
void print_hard_heading();
void print(const HardRow& row);

std::string csv(const std::vector<HardRow>& rows);

/// A line a figure, but for those that have to be 0 and are: they are counted, and cases that have no other are named.
std::string markdown(const std::vector<HardRow>& rows, bool whole);

/// The file, if there is a place for the table in it.
Result<std::string> marked_text(const std::filesystem::path& file);

/// Replaces what stands between the two marks in a file. Errors: no file, no marks.
Result<void> replace_table(const std::filesystem::path& file, const std::string& table);

}  // namespace weft::command
