// Runs the list of hard cases, and writes their figures.
#include "samples/weft/hard_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <utility>

#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/hardening.h"

namespace weft::command {

namespace {

constexpr double kBand = 0.02;   // of the cloths' size: how far perturbations may move what is left of a run
constexpr std::string_view kBegin = "<!-- weft harden: begin -->\n", kEnd = "<!-- weft harden: end -->";

std::string digits(double value, const char* format = "%.3g") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// How often the figure fits into its bound.
std::string margin(const HardRow& row) {
  if (std::isinf(row.bound)) return "published";
  if (row.bound == 0) return row.measured == 0 ? "exact" : "NOT HELD";
  if (!row.held()) return "NOT HELD";
  const double fits = row.bound / row.measured;
  return row.measured > 0 ? digits(fits, fits < 100 ? "%.2g" : "%.0f") + " x" : "exact";
}

std::string with_unit(double value, const std::string& unit) { return digits(value) + (unit.empty() ? "" : " " + unit); }

// A fault other than sag or shape exceeds any bound: NaN, which is within none, not even within an infinite one.
void widen(double& worst, double off, const std::vector<std::string>& faults) {
  const bool whole = std::all_of(faults.begin(), faults.end(), [](const std::string& fault) { return fault == "sag" || fault == "shape"; });
  worst = whole && !std::isnan(worst) ? std::max(100 * off, worst) : NAN;
}

// Groups in the order in which they come.
void add_groups(const Scene& scene, const std::string& file, bool quick, std::vector<SuiteItem>& items) {
  std::string last;
  for (const Perturbation& perturbation : all_perturbations(scene, quick))
    if (perturbation.group != std::exchange(last, perturbation.group)) items.push_back({nullptr, last, file, scene});
}

}  // namespace

Result<std::vector<SuiteItem>> suite_of(const std::filesystem::path& scenes, bool quick, std::string_view only) {
  std::vector<SuiteItem> items;
  for (const HardCase& hard : hard_cases()) {
    if ((quick && hard.large) || hard.name.find(only) == std::string_view::npos) continue;
    auto scene = scene_of(hard, scenes);
    if (!scene) return scene.take_error();
    items.push_back({&hard, "", std::string(hard.scene), std::move(*scene)});
  }
  if (std::string_view("invariance").find(only) == std::string_view::npos) return items;
  const auto scene = load_scene(scenes / "invariance.json"), rigid = load_scene(scenes / "invariance_rigid.json");
  if (!scene || !rigid) return fail((scene ? rigid : scene).why());
  add_groups(*scene, "invariance", quick, items);
  items.push_back({nullptr, "masses alone", "invariance_rigid", *rigid});   // rigid cloth must not change with mass alone either
  return items;
}

Result<std::vector<HardRow>> SuiteRunner::measure_group(const SuiteItem& item) {
  const Scene& scene = item.scene;
  if (base_of_ != item.scene_file) {
    auto run = run_perturbed(device_, scene, {}, scene.frames);
    if (!run) return fail(run.why());
    base_ = std::move(*run);
    base_of_ = item.scene_file;
  }
  std::vector<HardRow> rows;   // the mean, then the shape
  for (const Perturbation& perturbation : all_perturbations(scene, quick_)) {
    if (perturbation.group != item.group) continue;
    if (interrupted()) return rows;
    const auto seen = run_perturbed(device_, scene, perturbation, scene.frames);
    if (!seen) return fail(seen.why());
    if (rows.empty()) {   // what physics does see is published
      const auto bound = [&](double band) { return 100 * perturbation.bands * band; };
      rows = {{scene.name, "11", item.group + ": mean moves", "%", scene.name, bound(kBand), 0},
              {scene.name, "11", item.group + ": shape, rms", "%", scene.name, bound(kShapeBands * kBand), 0}};
    }
    const Difference off = difference(*seen, *base_);
    const std::vector<std::string> faults = broken(perturbation, *seen, *base_, kBand);
    widen(rows[0].measured, off.mean, faults);
    widen(rows[1].measured, off.shape, faults);
  }
  return rows;
}

Result<std::vector<HardRow>> SuiteRunner::measure(const SuiteItem& item) {
  if (item.hard == nullptr) return measure_group(item);
  const HardCase& hard = *item.hard;
  const auto figures = command::measure(device_, hard, item.scene);
  if (!figures) return fail(figures.why());
  std::vector<HardRow> rows;
  for (std::size_t k = 0; k < figures->size(); ++k) {
    const Check& check = hard.checks[k];
    rows.push_back({std::string(hard.name), std::string(hard.families), std::string(check.what), std::string(check.unit),
                    std::string(hard.scene), check.bound, (*figures)[k]});
  }
  return rows;
}

void print_hard_heading() {
  std::printf("%-26s %-8s %-36s %10s %10s %-4s %s\n", "case", "", "figure", "bound", "measured", "", "margin");
}

void print(const HardRow& row) {
  std::printf("%-26s %-8s %-36s %10s %10s %-4s %s\n", row.name.c_str(), row.families.c_str(), row.what.c_str(),
              std::isinf(row.bound) ? "-" : digits(row.bound).c_str(), digits(row.measured).c_str(), row.unit.c_str(), margin(row).c_str());
  std::fflush(stdout);
}

std::string csv(const std::vector<HardRow>& rows) {
  std::string text = "case,families,figure,unit,bound,measured\n";
  for (const HardRow& row : rows)
    text += '"' + row.name + "\",\"" + row.families + "\",\"" + row.what + "\"," + row.unit + ',' + digits(row.bound, "%g") + ',' +
            digits(row.measured, "%.9g") + '\n';
  return text;
}

std::string markdown(const std::vector<HardRow>& rows, bool whole) {
  std::string text = "| | case | figure | bound | measured | margin |\n|---|---|---|---|---|---|\n";
  std::size_t zero = 0;
  std::vector<std::string> all_zero;   // cases without any other figure
  for (const HardRow& row : rows) {
    if (row.bound == 0 && row.measured == 0) {
      ++zero;
      const bool more =
          std::any_of(rows.begin(), rows.end(), [&](const HardRow& r) { return r.name == row.name && !(r.bound == 0 && r.measured == 0); });
      if (!more && (all_zero.empty() || all_zero.back() != row.name)) all_zero.push_back(row.name);
      continue;
    }
    text += "| " + row.families + " | " + row.name + " | " + row.what + " | " +
            (std::isinf(row.bound) ? "" : with_unit(row.bound, row.unit)) + " | " + with_unit(row.measured, row.unit) + " | " +
            margin(row) + " |\n";
  }
  text += "\nAnother " + std::to_string(zero) + " figures have the bound 0 and are 0: particles not finite, pins off their place, " +
          "crossings, contacts lost, sheets out of order.\n";
  if (!all_zero.empty()) {
    text += "The whole of a case they are in ";
    for (std::size_t k = 0; k < all_zero.size(); ++k)
      text += (k == 0 ? "" : k + 1 == all_zero.size() ? " and " : ", ") + ("*" + all_zero[k] + "*");
    text += ".\n";
  }
  if (!whole) text += "Without the large cases and with a few perturbations only (`--quick`).\n";
  return text;
}

Result<std::string> marked_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail(file.string(), ": cannot be read");
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t begin = text.find(kBegin), end = text.find(kEnd);
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    return fail(file.string(), ": has no lines '", kBegin.substr(0, kBegin.size() - 1), "' and '", kEnd, "' for the table to go between");
  return text;
}

Result<void> replace_table(const std::filesystem::path& file, const std::string& table) {
  auto text = marked_text(file);
  if (!text) return text.take_error();
  const std::size_t begin = text->find(kBegin) + kBegin.size();
  text->replace(begin, text->find(kEnd) - begin, table);
  return write_text(file, *text);
}

}  // namespace weft::command
