// `weft harden SCENE`: runs a scene under every perturbation and reports what held. `weft harden FOLDER`: runs the hard cases, whose
// scenes are in that folder, and reports how far each stays from its bound.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/outputs.h"
#include "samples/weft/hard_run.h"
#include "samples/weft/hard_table.h"
#include "samples/weft/hardening.h"
#include "samples/weft/subject.h"

namespace weft::command {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kQuickFrames = 60;

std::string listed(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

std::string unjudged(const Perturbation& perturbation) {
  if (std::isinf(perturbation.bands)) return "; strain, mean and shape not judged";
  return perturbation.same_strain ? "" : "; strain not judged";
}

void print_row(const std::string& name, const PerturbedRun& seen, const Difference& off, const std::string& verdict) {
  std::printf("%-31s %6u %8.2g %8.3g %8.3g %6u %6llu %8.3g %8.3g %8.3g %7.3g  %s\n", name.c_str(), seen.non_finite, seen.pins_off,
              100 * seen.strain.max, 100 * seen.strain.rms, seen.overflowed, static_cast<unsigned long long>(seen.crossings),
              100 * off.mean, 100 * off.shape, seen.clamped, seen.wall, verdict.c_str());
  std::fflush(stdout);
}

Json json_of(const std::string& name, const PerturbedRun& seen, const Difference& off, const std::vector<std::string>& broken) {
  return {{"name", name}, {"non_finite", seen.non_finite}, {"pins_off_m", seen.pins_off},
          {"strain", {{"mean", seen.strain.mean}, {"rms", seen.strain.rms}, {"max", seen.strain.max}}},
          {"contacts_overflowed", seen.overflowed}, {"crossings", seen.crossings}, {"mean_moved", off.mean}, {"shape_rms", off.shape},
          {"simulated_seconds", seen.simulated}, {"clamped_seconds", seen.clamped}, {"wall_seconds", seen.wall}, {"broken", broken}};
}

struct Count {
  std::uint32_t runs = 0, broken = 0;
};

std::uint32_t frames_of(const Scene& scene, const HardenOptions& options) {
  return options.frames ? *options.frames : options.quick ? std::min(scene.frames, kQuickFrames) : scene.frames;
}

Result<Count> run_all(const compute::Device& device, const Scene& scene, const HardenOptions& options, Json& rows) {
  const std::vector<Perturbation> perturbations = all_perturbations(scene, options.quick);
  const std::uint32_t frames = frames_of(scene, options);
  std::printf("%-31s %6s %8s %8s %8s %6s %6s %8s %8s %8s %7s\n", "", "not", "pins", "strain", "strain", "lost", "cross-", "mean", "shape",
              "s given", "");
  std::printf("%-31s %6s %8s %8s %8s %6s %6s %8s %8s %8s %7s\n", "", "finite", "off m", "max %", "rms %", "", "ings", "off %", "off %",
              "back", "s");
  const auto base = run_perturbed(device, scene, {}, frames);
  if (!base) return base.error().empty() ? fail("nothing ran") : fail(base.why());
  if (interrupted()) return Count();   // it was not run to its end
  Count count{1, 0};
  const auto tell = [&](const Perturbation& perturbation, const PerturbedRun& seen) {
    const std::vector<std::string> faults = broken(perturbation, seen, *base, options.band);
    const Difference off = difference(seen, *base);
    const std::string name = perturbation.name.empty() ? "as it is" : perturbation.name;
    print_row(name, seen, off, faults.empty() ? "held" + unjudged(perturbation) : "NOT HELD: " + listed(faults));
    rows.push_back(json_of(name, seen, off, faults));
    count.broken += !faults.empty();
  };
  tell({}, *base);
  if (base->crossings > 0) std::printf("The scene crosses by itself, so none of what follows can hold that counts crossings\n");
  Progress progress("hardening " + scene.name, static_cast<std::uint32_t>(perturbations.size()), "perturbations");
  for (const Perturbation& perturbation : perturbations) {
    if (interrupted()) break;
    const auto seen = run_perturbed(device, scene, perturbation, frames);
    if (!seen) return fail(seen.why());
    if (interrupted()) break;
    tell(perturbation, *seen);
    ++count.runs;
    progress.step();
  }
  return count;
}

Exit harden_scene(const compute::Device& device, const Scene& scene, const HardenOptions& options) {
  if (const std::uint32_t frames = frames_of(scene, options), least = least_frames(scene); frames < least) {
    complain("--frames: a run of " + std::to_string(frames) + " frames has no room for the long one halfway; this scene takes at least " +
             std::to_string(least));
    return kBadInput;
  }
  // Every mistake of the scene's author is reported before anything runs.
  if (const Started started = start(device, scene, false); !started.simulation) return started.exit;
  std::printf("%s on %s: perturbed, then compared with the scene as it is; held: mean within %g %% of its size, shape within %g %%\n",
              scene.name.c_str(), device.name().c_str(), 100 * options.band, 100 * kShapeBands * options.band);
  Json report{{"scene", scene.name}, {"device", device.name()}, {"band", options.band}, {"rows", Json::array()}};
  const auto count = run_all(device, scene, options, report["rows"]);
  if (!count) return failed(count.error());
  report["interrupted"] = interrupted();
  if (const Result<void> written = write_text(options.out / "harden.json", report.dump(2) + "\n"); !written) return failed(written.error());
  std::printf("%u of %u held. Written: harden.json in %s\n", count->runs - count->broken, count->runs, options.out.string().c_str());
  if (interrupted()) {
    complain("Interrupted: what is written is of the perturbations before");
    return kInterrupted;
  }
  return count->broken == 0 ? kDone : kFailed;
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
  return inputs_of(options.file, scene);
}

Exit harden_suite(const compute::Device& device, const HardenOptions& options) {
  std::printf("%zu hard cases on %s\n", hard_cases().size(), device.name().c_str());
  const auto rows = run_suite(device, options.file, options.quick, options.only);
  if (!rows) return failed(rows.error());
  if (rows->empty() && !interrupted()) {
    complain("--only " + options.only + ": no hard case has this in its name");
    return kBadInput;
  }
  if (const Result<void> written = write_text(options.out / "hard_cases.csv", csv(*rows)); !written) return failed(written.error());
  if (!options.readme.empty() && !interrupted())
    if (const Result<void> replaced = replace_table(options.readme, markdown(*rows, !options.quick)); !replaced)
      return failed(replaced.error());
  const auto held = std::count_if(rows->begin(), rows->end(), [](const HardRow& row) { return row.held(); });
  std::printf("%zd of %zu figures are within their bounds. Written: hard_cases.csv in %s\n", held, rows->size(),
              options.out.string().c_str());
  if (interrupted()) {
    complain("Interrupted: what is written is of the cases before");
    return kInterrupted;
  }
  return held == static_cast<std::ptrdiff_t>(rows->size()) ? kDone : kFailed;
}

}  // namespace

Exit harden(const HardenOptions& options) {
  const bool suite = is_folder(options.file);
  if (suite && (!options.assignments.empty() || options.frames)) {
    complain(options.file.string() + ": the hard cases run as they are, without --set or --frames");
    return kBadInput;
  }
  if (!suite && !options.readme.empty()) {
    complain("--readme: goes with the folder of the hard cases, not with a scene");
    return kBadInput;
  }
  Scene scene;
  const auto inputs = find_inputs(options, suite, scene);
  if (!inputs) {
    complain(inputs.error());
    return kBadInput;
  }
  listen_for_interrupts();
  const std::string name = suite ? "hard_cases.csv" : "harden.json";
  if (const Exit exit = prepare_outputs(options.out, {&name, 1}, *inputs); exit != kDone) return exit;
  if (!options.readme.empty())
    if (const Result<void> writable = probe_file(options.readme); !writable) return failed(writable.error());
  compute::DeviceChoice choice;
  choice.name = options.device;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());
  return suite ? harden_suite(**device, options) : harden_scene(**device, scene, options);
}

}  // namespace weft::command
