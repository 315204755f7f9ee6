// Runs the list of hard cases, and writes their figures.
#include "samples/weft/hard_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>

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

void print(const HardRow& row) {
  std::printf("%-26s %-8s %-36s %10s %10s %-4s %s\n", row.name.c_str(), row.families.c_str(), row.what.c_str(),
              std::isinf(row.bound) ? "-" : digits(row.bound).c_str(), digits(row.measured).c_str(), row.unit.c_str(), margin(row).c_str());
  std::fflush(stdout);
}

// A fault other than sag or shape exceeds any bound: NaN, which is within none, not even within an infinite one.
void widen(double& worst, double off, const std::vector<std::string>& faults) {
  const bool whole = std::all_of(faults.begin(), faults.end(), [](const std::string& fault) { return fault == "sag" || fault == "shape"; });
  worst = whole && !std::isnan(worst) ? std::max(100 * off, worst) : NAN;
}

// `group`: of the perturbations only these; empty: all.
Result<void> add_invariance(const compute::Device& device, const std::filesystem::path& file, std::string_view group, bool quick,
                            std::vector<HardRow>& rows) {
  const auto scene = load_scene(file);
  if (!scene) return fail(scene.why());
  const auto base = run_perturbed(device, *scene, {}, scene->frames);
  if (!base) return fail(base.why());
  std::vector<HardRow> found;   // two a group: the mean, then the shape
  for (const Perturbation& perturbation : all_perturbations(*scene, quick)) {
    if (!group.empty() && perturbation.group != group) continue;
    if (interrupted()) return {};
    const auto seen = run_perturbed(device, *scene, perturbation, scene->frames);
    if (!seen) return fail(seen.why());
    auto row = std::find_if(found.begin(), found.end(), [&](const HardRow& r) { return r.what.starts_with(perturbation.group + ":"); });
    if (row == found.end()) {   // what physics does see is published
      const auto bound = [&](double band) { return 100 * perturbation.bands * band; };
      const HardRow two[] = {{scene->name, "11", perturbation.group + ": mean moves", "%", scene->name, bound(kBand), 0},
                             {scene->name, "11", perturbation.group + ": shape, rms", "%", scene->name, bound(kShapeBands * kBand), 0}};
      row = found.insert(row, std::begin(two), std::end(two));
    }
    const Difference off = difference(*seen, *base);
    const std::vector<std::string> faults = broken(perturbation, *seen, *base, kBand);
    widen(row->measured, off.mean, faults);
    widen((row + 1)->measured, off.shape, faults);
  }
  for (HardRow& row : found) print(row);
  rows.insert(rows.end(), found.begin(), found.end());
  return {};
}

}  // namespace

Result<std::vector<HardRow>> run_suite(const compute::Device& device, const std::filesystem::path& scenes, bool quick,
                                       std::string_view only) {
  std::vector<HardRow> rows;
  std::printf("%-26s %-8s %-36s %10s %10s %-4s %s\n", "case", "", "figure", "bound", "measured", "", "margin");
  for (const HardCase& hard : hard_cases()) {
    if (interrupted()) return rows;
    if ((quick && hard.large) || hard.name.find(only) == std::string_view::npos) continue;
    const auto scene = scene_of(hard, scenes);
    if (!scene) return fail(scene.why());
    const auto figures = measure(device, hard, *scene);
    if (!figures) return fail(figures.why());
    if (interrupted()) return rows;   // a case that was cut short has no figures
    for (std::size_t k = 0; k < figures->size(); ++k) {
      const Check& check = hard.checks[k];
      print(rows.emplace_back(HardRow{std::string(hard.name), std::string(hard.families), std::string(check.what), std::string(check.unit),
                                      std::string(hard.scene), check.bound, (*figures)[k]}));
    }
  }
  if (std::string_view("invariance").find(only) == std::string_view::npos) return rows;
  if (auto done = add_invariance(device, scenes / "invariance.json", "", quick, rows); !done) return done.take_error();
  // Rigid cloth must not change with mass alone either.
  if (auto done = add_invariance(device, scenes / "invariance_rigid.json", "masses alone", quick, rows); !done) return done.take_error();
  return rows;
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
