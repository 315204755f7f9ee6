// `weft harden SCENE`: runs a scene under every perturbation and reports what held. `weft harden FOLDER`: runs the hard cases, whose
// scenes are in that folder, and reports how far each stays from its bound.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/hard_run.h"
#include "samples/weft/hard_table.h"
#include "samples/weft/hardening.h"
#include "samples/weft/merge.h"
#include "samples/weft/outputs.h"
#include "samples/weft/shard.h"
#include "samples/weft/subject.h"

namespace weft::command {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kQuickFrames = 60;
constexpr const char *kHardenReport = "harden.json", *kCasesTable = "hard_cases.csv";

std::string listed(const Row& words) {
  std::string list;
  for (const Row& word : words) list += (list.empty() ? "" : ", ") + word.get<std::string>();
  return list;
}

std::string unjudged(const Perturbation& perturbation) {
  if (std::isinf(perturbation.bands)) return "; strain, mean and shape not judged";
  return perturbation.same_strain ? "" : "; strain not judged";
}

void print_heading() {
  std::printf("%-31s %6s %8s %8s %8s %6s %6s %8s %8s %8s %7s\n", "", "not", "pins", "strain", "strain", "lost", "cross-", "mean", "shape",
              "s given", "");
  std::printf("%-31s %6s %8s %8s %8s %6s %6s %8s %8s %8s %7s\n", "", "finite", "off m", "max %", "rms %", "", "ings", "off %", "off %",
              "back", "s");
}

void print_row(const Row& row) {
  const Row& report = row.at("report");
  const auto number = [&](const char* key, double factor = 1) { return factor * report.at(key).get<double>(); };
  const Row &strain = report.at("strain"), &broken = report.at("broken");
  const std::string verdict = broken.empty() ? row.at("verdict").get<std::string>() : "NOT HELD: " + listed(broken);
  std::printf("%-31s %6u %8.2g %8.3g %8.3g %6u %6llu %8.3g %8.3g %8.3g %7.3g  %s\n", report.at("name").get<std::string>().c_str(),
              report.at("non_finite").get<std::uint32_t>(), number("pins_off_m"), 100 * strain.at("max").get<double>(),
              100 * strain.at("rms").get<double>(), report.at("contacts_overflowed").get<std::uint32_t>(),
              static_cast<unsigned long long>(report.at("crossings").get<std::uint64_t>()), number("mean_moved", 100),
              number("shape_rms", 100), number("clamped_seconds"), number("wall_seconds"), verdict.c_str());
  std::fflush(stdout);
}

// In the order of harden.json, where it begins.
constexpr const char* kReportKeys[] = {"name", "non_finite", "pins_off_m", "strain", "contacts_overflowed", "crossings", "mean_moved",
                                       "shape_rms", "simulated_seconds", "clamped_seconds", "wall_seconds", "broken"};

Row row_of(const Perturbation& perturbation, const PerturbedRun& seen, const PerturbedRun& base, double band) {
  const Difference off = difference(seen, base);
  const Row report = {{"name", perturbation.name.empty() ? "as it is" : perturbation.name}, {"non_finite", seen.non_finite},
                      {"pins_off_m", seen.pins_off},
                      {"strain", {{"mean", seen.strain.mean}, {"rms", seen.strain.rms}, {"max", seen.strain.max}}},
                      {"contacts_overflowed", seen.overflowed}, {"crossings", seen.crossings}, {"mean_moved", off.mean},
                      {"shape_rms", off.shape}, {"simulated_seconds", seen.simulated}, {"clamped_seconds", seen.clamped},
                      {"wall_seconds", seen.wall}, {"broken", broken(perturbation, seen, base, band)}};
  return {{"report", report}, {"verdict", "held" + unjudged(perturbation)}};
}

// What is at random at the start is drawn anew.
void reseed(Scene& scene, const std::optional<std::uint32_t>& seed) {
  if (!seed) return;
  for (Cloth& cloth : scene.cloths) cloth.start.seed = *seed;
}

std::uint32_t frames_of(const Scene& scene, const HardenOptions& options) {
  return options.frames ? *options.frames : options.quick ? std::min(scene.frames, kQuickFrames) : scene.frames;
}

Exit conclude_scene(const Rows& all, const std::filesystem::path& out) {
  const Row& facts = all.work.facts;
  Json report{{"scene", facts.at("scene")}, {"device", facts.at("device")}, {"band", facts.at("band")}, {"rows", Json::array()}};
  std::size_t held = 0;
  for (const auto& [item, row] : all.rows) {
    Json& added = report["rows"].emplace_back();
    for (const char* key : kReportKeys) added[key] = row.at("report").at(key);
    held += row.at("report").at("broken").empty();
  }
  report["interrupted"] = !all.all();
  if (const Result<void> written = write_text(out / kHardenReport, report.dump(2) + "\n"); !written) return failed(written.error());
  if (all.rows.contains(0) && all.rows.at(0).at("report").at("crossings") > 0)
    std::printf("The scene crosses by itself, so none of this can hold that counts crossings\n");
  std::printf("%zu of %zu held. Written: %s in %s\n", held, all.rows.size(), kHardenReport, out.string().c_str());
  return held == all.rows.size() ? kDone : kFailed;
}

// The scene as it is comes first. The others are compared with it, so each part runs it.
Exit harden_scene(const compute::Device& device, const Scene& scene, const HardenOptions& options) {
  const std::uint32_t frames = frames_of(scene, options), least = least_frames(scene);
  if (frames < least) {
    complain("--frames: a run of " + std::to_string(frames) + " frames has no room for the long one halfway; this scene takes at least " +
             std::to_string(least));
    return kBadInput;
  }
  // Every mistake of the scene's author is reported before anything runs.
  if (const Started started = start(device, scene, false); !started.simulation) return started.exit;
  std::printf("%s on %s: perturbed, then compared with the scene as it is; held: mean within %g %% of its size, shape within %g %%\n",
              scene.name.c_str(), device.name().c_str(), 100 * options.band, 100 * kShapeBands * options.band);
  print_heading();
  std::vector<Perturbation> perturbations = all_perturbations(scene, options.quick);
  perturbations.insert(perturbations.begin(), Perturbation());
  std::optional<PerturbedRun> base;
  Labour labour;
  labour.unit = "perturbations";
  labour.measure = [&](std::uint32_t item) -> Result<Row> {
    if (!base) {
      auto run = run_perturbed(device, scene, {}, frames);
      if (!run) return run.error().empty() ? fail("nothing ran") : fail(run.why());
      base = std::move(*run);
    }
    if (interrupted()) return fail("interrupted");
    const auto seen = item == 0 ? Result(*base) : run_perturbed(device, scene, perturbations[item], frames);
    if (!seen) return fail(seen.why());
    Row row = row_of(perturbations[item], *seen, *base, options.band);
    if (!interrupted()) print_row(row);
    return row;
  };
  labour.conclude = [&](const Rows& all) { return conclude_scene(all, options.out); };
  Work work{"harden", {{"scene", scene.name}, {"device", device.name()}, {"band", options.band}, {"frames", frames},
                       {"quick", options.quick}}};
  work.of = fingerprint_of(scene, options.file);
  work.items = static_cast<std::uint32_t>(perturbations.size());
  return work_through(work, labour, options.farm, options.out);
}

// What the hard cases read. What is wrong with their folder, or with the place of their table, is reported before any of them runs.
Result<std::vector<Input>> check_suite(const HardenOptions& options) {
  std::vector<Input> inputs;
  for (const HardCase& hard : hard_cases()) {
    auto scene = scene_of(hard, options.file);
    if (!scene) return scene.take_error();
    for (Input& input : inputs_of(options.file / (std::string(hard.scene) + ".json"), *scene)) inputs.push_back(std::move(input));
  }
  if (options.readme.empty()) return inputs;
  inputs.push_back({options.readme, "the file of --readme"});
  auto text = marked_text(options.readme);
  return text ? Result(std::move(inputs)) : text.take_error();
}

// What a scene, or the hard cases, read.
Result<std::vector<Input>> find_inputs(const HardenOptions& options, bool suite, Scene& scene) {
  if (suite) return check_suite(options);
  auto loaded = load_subject(options.file, options.assignments, options.buffer_files);
  if (!loaded) return loaded.take_error();
  scene = std::move(*loaded);
  reseed(scene, options.seed);
  return inputs_of(options.file, scene);
}

Exit conclude_suite(const Rows& all, const std::filesystem::path& out, const std::filesystem::path& readme) {
  std::vector<HardRow> rows;
  for (const auto& [item, row] : all.rows)
    for (const Row& figure : row.at("figures")) rows.push_back(figure.get<HardRow>());
  if (const Result<void> written = write_text(out / kCasesTable, csv(rows)); !written) return failed(written.error());
  if (!readme.empty() && all.all())
    if (const Result<void> replaced = replace_table(readme, markdown(rows, !all.work.facts.at("quick").get<bool>())); !replaced)
      return failed(replaced.error());
  const auto held = std::ranges::count_if(rows, &HardRow::held);
  std::printf("%zd of %zu figures are within their bounds. Written: %s in %s\n", held, rows.size(), kCasesTable, out.string().c_str());
  return held == static_cast<std::ptrdiff_t>(rows.size()) ? kDone : kFailed;
}

Exit harden_suite(const compute::Device& device, const HardenOptions& options) {
  std::printf("%zu hard cases on %s\n", hard_cases().size(), device.name().c_str());
  auto suite = suite_of(options.file, options.quick, options.only);
  if (!suite) return failed(suite.error());
  for (SuiteItem& item : *suite) reseed(item.scene, options.seed);
  if (suite->empty()) {
    complain("--only " + options.only + ": no hard case has this in its name");
    return kBadInput;
  }
  print_hard_heading();
  SuiteRunner runner(device, options.quick);
  Labour labour;
  labour.unit = "cases";
  labour.measure = [&](std::uint32_t item) -> Result<Row> {
    const auto figures = runner.measure((*suite)[item]);
    if (!figures) return fail(figures.why());
    if (!interrupted())
      for (const HardRow& row : *figures) print(row);
    return Row{{"figures", *figures}};
  };
  labour.conclude = [&](const Rows& all) { return conclude_suite(all, options.out, options.readme); };
  Work work{"hard_cases", {{"device", device.name()}, {"quick", options.quick}, {"only", options.only}}};
  for (const SuiteItem& item : *suite) work.of += fingerprint_of(item.scene, options.file / (item.scene_file + ".json"));
  work.items = static_cast<std::uint32_t>(suite->size());
  return work_through(work, labour, options.farm, options.out);
}

// A fault of the call, a sentence, or nothing.
std::string contradiction(const HardenOptions& options, bool suite) {
  if (suite && (!options.assignments.empty() || options.frames))
    return options.file.string() + ": the hard cases run as they are, without --set or --frames";
  if (!suite && !options.readme.empty()) return "--readme: goes with the folder of the hard cases, not with a scene";
  return "";
}

}  // namespace

Exit harden(const HardenOptions& options) {
  const bool suite = is_folder(options.file);
  if (const std::string fault = contradiction(options, suite); !fault.empty()) {
    complain(fault);
    return kBadInput;
  }
  Scene scene;
  const auto inputs = find_inputs(options, suite, scene);
  if (!inputs) {
    complain(inputs.error());
    return kBadInput;
  }
  listen_for_interrupts();
  const std::vector<std::string> names =
      suite ? outputs_of("hard_cases", options.farm.shard, {kCasesTable}) : outputs_of("harden", options.farm.shard, {kHardenReport});
  if (const Exit exit = prepare_outputs(options.out, names, *inputs); exit != kDone) return exit;
  if (!options.readme.empty())
    if (const Result<void> writable = probe_file(options.readme); !writable) return failed(writable.error());
  compute::DeviceChoice choice;
  choice.name = options.device;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());
  return suite ? harden_suite(**device, options) : harden_scene(**device, scene, options);
}

Mergeable merged_harden() {
  return {"harden", {kHardenReport}, [](const Rows& all, const std::filesystem::path& out) {
            print_heading();
            for (const auto& [item, row] : all.rows) print_row(row);
            return conclude_scene(all, out);
          }};
}

Mergeable merged_hard_cases() {
  return {"hard_cases", {kCasesTable}, [](const Rows& all, const std::filesystem::path& out) {
            print_hard_heading();
            for (const auto& [item, row] : all.rows)
              for (const Row& figure : row.at("figures")) print(figure.get<HardRow>());
            return conclude_suite(all, out, {});
          }};
}

}  // namespace weft::command
