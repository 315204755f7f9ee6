// `weft accuracy`: error over milliseconds, on the device at hand.
//
// Settings are measured one by one, cheapest first, and each is in curve.csv before the next begins: an interrupted sweep
// leaves a usable curve, and goes on where it stopped when it is called again. Plots and page are made from the curve.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>

#include "engine/reference/choice.h"
#include "samples/weft/accuracy_page.h"
#include "samples/weft/accuracy_reference.h"
#include "samples/weft/accuracy_sweep.h"
#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/outputs.h"
#include "samples/weft/painter.h"
#include "samples/weft/subject.h"

namespace weft::command {

namespace {

constexpr VkExtent2D kShotSize = {640, 480};
constexpr std::size_t kMostShots = 6;   // three budgets, with tethers and without

std::string shot_name(std::size_t number) { return "budget_" + std::to_string(number) + ".png"; }

SweepPlan plan_of(const Scene& scene, const AccuracyOptions& options) {
  SweepPlan plan;
  std::uint32_t own = 0;
  bool held = false, tethered = false;
  for (const Cloth& cloth : scene.cloths) {
    if (cloth.grid) own = std::max({own, cloth.grid->cells_x, cloth.grid->cells_y});
    held |= !cloth.anchors.empty();
    tethered |= !cloth.anchors.empty() && cloth.tethers;
  }
  plan.frames = options.frames.value_or(options.quick ? 24 : 48);
  plan.warm_up = plan.frames / 4;
  plan.reference_cells = options.reference_cells.value_or(options.quick ? 16 : 32);
  plan.most_steps = options.quick ? 80 : 320;
  plan.substeps =
      options.quick ? std::vector<std::uint32_t>{1, 2, 5, 10, 20} : std::vector<std::uint32_t>{1, 2, 5, 10, 20, 40, 80, 160, 320};
  plan.iterations = options.quick ? std::vector<std::uint32_t>{1, 4} : std::vector<std::uint32_t>{1, 4, 16};
  plan.most_passes = plan.substeps.back();
  plan.most_iterated = options.quick ? 8 : 40;
  plan.most_particle_passes = options.quick ? 0.5e6 : 3.3e6;
  for (const std::uint32_t cells :
       options.quick ? std::vector<std::uint32_t>{plan.reference_cells} : std::vector<std::uint32_t>{plan.reference_cells, 99})
    if (cells > 0 && cells < own) plan.cells.push_back(cells);
  plan.cells.push_back(own);
  plan.tethers = {tethered};
  if (held && !options.quick) plan.tethers.push_back(!tethered);
  return plan;
}

std::string now() {
  const std::time_t time = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%MZ", std::gmtime(&time));
  return text;
}

// What points must have in common to stand in one curve.
std::string key_of(const Scene& scene, const SweepPlan& plan, const std::string& device) {
  Fingerprint print;
  return print.add(scene_text(scene)).add(device).add(&plan.frames, sizeof plan.frames).add(&plan.most_steps, sizeof plan.most_steps)
      .add(&plan.reference_cells, sizeof plan.reference_cells).text();
}

Result<std::string> read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return fail(file.string(), ": cannot be read");
  return text;
}

// The curve that a sweep continues.
Result<Curve> begun(const std::filesystem::path& file, const Curve& fresh, bool anew) {
  if (anew || !is_there(file)) return fresh;
  auto text = read_text(file);
  if (!text) return text.take_error();
  auto curve = parse_curve(*text);
  if (!curve) return fail(file.string(), ": ", curve.why());
  if (curve->key != fresh.key)
    return fail(file.string(),
                ": is a curve of another scene, device or number of frames; choose another --out, or begin anew with --fresh");
  return curve;
}

std::uint32_t units(const Setting& setting) { return 1 + static_cast<std::uint32_t>(std::min(setting.work / 1e6, 1e6)); }

struct Swept {
  Curve curve;
  std::vector<std::string> notes;
};

Result<void> sweep(const compute::Device& device, const Scene& scene, const SweepPlan& plan, const std::filesystem::path& folder,
                   Swept& swept) {
  std::vector<Setting> settings = settings_of(scene, plan, swept.notes);
  std::erase_if(settings, [&](const Setting& setting) {
    return std::any_of(swept.curve.points.begin(), swept.curve.points.end(), [&](const CurvePoint& point) { return setting == point; });
  });
  std::uint32_t total = 0;
  for (const Setting& setting : settings) total += units(setting);
  std::printf("%zu settings to measure, %zu are in %s already\n", settings.size(), swept.curve.points.size(), folder.string().c_str());
  std::fflush(stdout);

  std::string no_reference;
  Progress progress("measuring", total, "million particle passes");
  for (const Setting& setting : settings) {
    const bool compared = no_reference.empty();
    auto point = measure(device, scene, setting, plan, folder, no_reference);
    if (interrupted()) break;
    if (compared && !no_reference.empty()) swept.notes.push_back("no reference: " + no_reference);
    progress.step(units(setting));
    if (!point && device.is_lost()) return fail(setting.row.name, ": ", point.why());
    if (!point) {
      const std::string sentence = std::string(setting.row.name) + ": " + point.error();
      if (std::find(swept.notes.begin(), swept.notes.end(), sentence) == swept.notes.end()) swept.notes.push_back(sentence);
      continue;
    }
    swept.curve.points.push_back(std::move(*point));
    if (auto written = write_text(folder / "curve.csv", curve_csv(swept.curve)); !written) return written;
  }
  return {};
}

// The cheapest setting of the front, the best, and the one between them.
std::vector<CurvePoint> three_budgets(const std::vector<CurvePoint>& points) {
  const std::vector<std::size_t> best = front(points, &CurvePoint::strain_rms);
  if (best.empty()) return {};
  const double middle = std::sqrt(points[best.front()].ms_median * points[best.back()].ms_median);
  std::size_t between = best.front();
  for (const std::size_t i : best)
    if (points[i].ms_median <= middle) between = i;
  return {points[best.front()], points[between], points[best.back()]};
}

// Pictures are taken on a device of its own, after everything has been timed: the times of a software driver that has drawn are wrong.
Exit take_shots(const Scene& scene, const Swept& swept, const AccuracyOptions& options, std::vector<Shot>& shots) {
  compute::DeviceChoice choice;
  choice.name = options.device;
  choice.graphics = true;
  const auto device = compute::Device::create(choice);
  if (!device) return kDone;   // a device that cannot draw can be measured all the same
  for (const bool tethers : {true, false}) {
    const auto points = three_budgets(points_of(swept.curve, largest(swept.curve), tethers));
    for (const CurvePoint& point : points) {
      const auto* row =
          std::find_if(std::begin(kSolverRows), std::end(kSolverRows), [&](const SolverRow& r) { return r.name == point.row; });
      if (row == std::end(kSolverRows)) continue;
      const auto made = scene_of(scene, Setting{*row, point.cells, tethers, point.substeps, point.iterations, 0});
      if (!made) return failed(made.error());
      const Started started = start(**device, *made, false);
      if (!started.simulation) return started.exit;
      Painter painter;
      if (const Exit exit = painter.create(**device, *started.simulation, kShotSize); exit != kDone) return exit;
      for (std::uint32_t frame = 0; frame < swept.curve.frames && !interrupted(); ++frame)
        if (auto advance = started.simulation->advance(1 / made->solver.rate); !advance) return failed(advance.error());
      if (interrupted()) return kInterrupted;
      const std::filesystem::path file = options.out / shot_name(shots.size() + 1);
      if (auto drawn = painter.draw(*started.simulation, file); !drawn) return failed(drawn.error());
      auto png = read_text(file);
      if (!png) return failed(png.error());
      char ms[32];
      std::snprintf(ms, sizeof ms, "%.3g ms", point.ms_median);
      shots.push_back({std::string(ms) + (tethers ? ", with tethers: " : ", without tethers: ") + setting_words(point) + "; strain " +
                           percent(point.strain_rms) + " rms, " + percent(point.strain_max) + " at most",
                       {png->begin(), png->end()}});
    }
  }
  return kDone;
}

Result<void> prepare_to_save(const std::string& device) {
  const std::filesystem::path file = curve_file(device);
  if (file.empty()) return fail("--save: neither XDG_CACHE_HOME nor HOME is an absolute path to save in");
  if (Result<void> made = make_folder(file.parent_path()); !made) return made;
  return probe_file(file, Link::replace);
}

void print_front(const Curve& curve, bool tethers) {
  const auto points = points_of(curve, largest(curve), tethers);
  const auto best = front(points, &CurvePoint::strain_rms);
  if (best.empty()) return;
  std::printf("%zu particles, %s tethers; no setting is both faster and strained less than one of these:\n%10s %10s %10s %10s  %s\n",
              static_cast<std::size_t>(points[0].particles), tethers ? "with" : "without", "ms", "rms", "largest", "h/16", "setting");
  for (const std::size_t i : best) {
    const CurvePoint& p = points[i];
    char distance[32] = "-";
    if (std::isfinite(p.total_error)) std::snprintf(distance, sizeof distance, "%.2e", p.total_error);
    std::printf("%10.3g %10s %10s %10s  %s\n", p.ms_median, percent(p.strain_rms).c_str(), percent(p.strain_max).c_str(), distance,
                setting_words(p).c_str());
  }
}

void print_budget(const Curve& curve, bool tethers, double budget) {
  const auto points = points_of(curve, largest(curve), tethers);
  const auto found = best(points, &CurvePoint::strain_rms, budget);
  if (!found) {
    const auto all = front(points, &CurvePoint::strain_rms);
    if (all.empty()) std::printf("Nothing was measured that could be compared with a budget\n");
    else
      std::printf("No setting fits %g ms: the cheapest takes %.3g ms, %s\n", budget, points[all[0]].ms_median,
                  setting_words(points[all[0]]).c_str());
    return;
  }
  const CurvePoint& p = points[*found];
  std::printf("Within %g ms: %s takes %.3g ms for %zu particles; strain %s rms, %s at most\nweft run SCENE %s\n", budget,
              setting_words(p).c_str(), p.ms_median, static_cast<std::size_t>(p.particles), percent(p.strain_rms).c_str(),
              percent(p.strain_max).c_str(), setting_flags(p).c_str());
}

}  // namespace

Exit accuracy(const AccuracyOptions& options) {
  Result<Scene> scene = load_subject(options.file, options.assignments, options.buffer_files);
  if (!scene) {
    complain(scene.error());
    return kBadInput;
  }
  listen_for_interrupts();
  std::vector<std::string> names = {"curve.csv", "curve.svg", "curve.html", "curve.png"};
  for (std::size_t k = 1; k <= kMostShots; ++k) names.push_back(shot_name(k));
  if (const Exit exit = prepare_outputs(options.out, names, inputs_of(options.file, *scene)); exit != kDone) return exit;
  compute::DeviceChoice choice;
  choice.name = options.device;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());

  if (options.save)
    if (const Result<void> place = prepare_to_save((*device)->name()); !place) return failed(place.error());

  const SweepPlan plan = plan_of(*scene, options);
  Curve fresh{(*device)->name(), scene->name, now(), key_of(*scene, plan, (*device)->name()), plan.frames, {}};
  auto curve = begun(options.out / "curve.csv", fresh, options.fresh);
  if (!curve) {
    complain(curve.error());
    return kBadInput;
  }
  Swept swept{std::move(*curve), {}};
  std::printf("%s on %s: %u frames a setting\n", scene->name.c_str(), (*device)->name().c_str(), plan.frames);
  if (const Result<void> done = sweep(**device, *scene, plan, options.out, swept); !done) return failed(done.error());
  for (const std::string& note : swept.notes) std::printf("note: %s\n", note.c_str());
  if (swept.curve.points.empty() && !interrupted()) return failed("No setting could be measured");
  if (swept.curve.points.empty()) {
    complain("Interrupted before a setting was measured: nothing is written");
    return kInterrupted;
  }

  std::vector<Shot> shots;
  if (!interrupted())
    if (const Exit exit = take_shots(*scene, swept, options, shots); exit != kDone && exit != kInterrupted) return exit;
  const Drawing drawing = accuracy_plot(swept.curve);
  const Page page{swept.curve, plan, swept.notes, std::move(shots), interrupted()};
  const std::pair<const char*, std::string> files[] = {
      {"curve.csv", curve_csv(swept.curve)}, {"curve.svg", svg(drawing)}, {"curve.html", accuracy_page(page)}};
  for (const auto& [name, text] : files)
    if (const Result<void> written = write_text(options.out / name, text); !written) return failed(written.error());
  if (const Result<void> written = write_png(options.out / "curve.png", picture(drawing)); !written) return failed(written.error());
  for (const bool tethers : plan.tethers) print_front(swept.curve, tethers);
  if (options.budget_ms) print_budget(swept.curve, plan.tethers.front(), *options.budget_ms);
  if (options.save) {
    const std::filesystem::path file = curve_file((*device)->name());
    if (const Result<void> written = write_text(file, curve_csv(condensed(swept.curve)), Link::replace); !written)
      return failed(written.error());
    std::printf("Saved for scenes whose solver is \"auto\": %s\n", file.string().c_str());
  }
  std::printf("Written: curve.csv, curve.svg, curve.png, curve.html in %s\n", options.out.string().c_str());
  if (!interrupted()) return kDone;
  complain("Interrupted after " + std::to_string(swept.curve.points.size()) + " settings; the same command goes on from here");
  return kInterrupted;
}

}  // namespace weft::command
