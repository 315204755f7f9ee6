// `weft accuracy`: error over milliseconds, on the device at hand.
//
// Settings are measured one by one, cheapest first: an interrupted sweep leaves a usable curve, and goes on where it stopped when it is
// called again. Plots and page are made from the curve.
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
#include "samples/weft/merge.h"
#include "samples/weft/outputs.h"
#include "samples/weft/painter.h"
#include "samples/weft/shard.h"
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
  if (own > 0)
    for (const std::uint32_t side : options.sides) plan.cells.push_back(side - 1);
  if (plan.cells.empty()) {
    for (const std::uint32_t cells :
         options.quick ? std::vector<std::uint32_t>{plan.reference_cells} : std::vector<std::uint32_t>{plan.reference_cells, 99})
      if (cells > 0 && cells < own) plan.cells.push_back(cells);
    plan.cells.push_back(own);
  }
  std::ranges::sort(plan.cells);
  plan.cells.erase(std::unique(plan.cells.begin(), plan.cells.end()), plan.cells.end());
  plan.most_particle_passes = options.quick ? 0.5e6 : 3.3e6;
  if (!options.sides.empty()) plan.free_passes = 20;   // twice the default's, at every size that was asked for
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

Result<std::string> read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return fail(file.string(), ": cannot be read");
  return text;
}

std::uint32_t units(const Setting& setting) { return 1 + static_cast<std::uint32_t>(std::min(setting.work / 1e6, 1e6)); }

struct Swept {
  Curve curve;
  std::vector<std::string> notes;
};

// The options that a merge needs again, to make the pages that the command makes.
Row facts_of(const AccuracyOptions& options, const SweepPlan& plan, const Scene& scene, const std::string& device) {
  Row facts = {{"device", device}, {"scene", scene.name}, {"quick", options.quick}, {"frames", plan.frames},
               {"reference_cells", plan.reference_cells}, {"sides", options.sides},
               {"outside", options.buffer_files == BufferFiles::anywhere}, {"set", Row::array()}};
  for (const Assignment& assignment : options.assignments) facts["set"].push_back({assignment.path, assignment.value});
  return facts;
}

AccuracyOptions options_of(const Work& work) {
  AccuracyOptions options;
  options.file = work.place.at("file").get<std::string>();
  options.device = work.facts.at("device").get<std::string>();
  options.quick = work.facts.at("quick").get<bool>();
  options.frames = work.facts.at("frames").get<std::uint32_t>();
  options.reference_cells = work.facts.at("reference_cells").get<std::uint32_t>();
  options.sides = work.facts.at("sides").get<std::vector<std::uint32_t>>();
  if (work.facts.at("outside").get<bool>()) options.buffer_files = BufferFiles::anywhere;
  for (const Row& set : work.facts.at("set"))
    options.assignments.push_back({set.at(0).get<std::string>(), set.at(1).get<std::string>()});
  return options;
}

// A row is a point or a note on why there is none, and a note on what the point lacks.
Result<Row> measure_row(const compute::Device& device, const Scene& scene, const SweepPlan& plan, const Setting& setting,
                        const std::filesystem::path& folder) {
  std::string no_reference;
  const auto point = measure(device, scene, setting, plan, folder, no_reference);
  if (!point && device.is_lost()) return fail(setting.row.name, ": ", point.why());
  Row row = Row::object();
  if (point) row["point"] = curve_csv({"", "", "", "", 0, {*point}});
  else row["note"] = std::string(setting.row.name) + ": " + point.error();
  if (!no_reference.empty()) row["lacks"] = "no reference: " + no_reference;
  return row;
}

Result<Swept> swept_of(const Rows& all, std::vector<std::string> notes) {
  const Row &facts = all.work.facts, &place = all.work.place;
  Swept swept{{facts.at("device").get<std::string>(), facts.at("scene").get<std::string>(), place.at("date").get<std::string>(),
               all.work.of, facts.at("frames").get<std::uint32_t>(), {}},
              std::move(notes)};
  for (const auto& [item, row] : all.rows) {
    for (const char* key : {"lacks", "note"}) {
      const std::string note = row.value(key, "");
      if (!note.empty() && std::ranges::find(swept.notes, note) == swept.notes.end()) swept.notes.push_back(note);
    }
    if (!row.contains("point")) continue;
    auto one = parse_curve(row.at("point").get<std::string>());
    if (!one) return fail("row ", item, ": ", one.why());
    std::ranges::move(one->points, std::back_inserter(swept.curve.points));
  }
  return swept;
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

void print_front(const Curve& curve, std::uint32_t cells, bool tethers) {
  const auto points = points_of(curve, cells, tethers);
  const auto best = front(points, &CurvePoint::strain_rms);
  if (best.empty()) return;
  std::printf("%zu particles, %s tethers; no setting is both faster and strained less than one of these:\n%10s %10s %10s %10s %10s  %s\n",
              static_cast<std::size_t>(points[0].particles), tethers ? "with" : "without", "ms", "dispatches", "rms", "largest", "h/16",
              "setting");
  for (const std::size_t i : best) {
    const CurvePoint& p = points[i];
    char distance[32] = "-";
    if (std::isfinite(p.total_error)) std::snprintf(distance, sizeof distance, "%.2e", p.total_error);
    std::printf("%10.3g %10.0f %10s %10s %10s  %s\n", p.ms_median, p.dispatches, percent(p.strain_rms).c_str(),
                percent(p.strain_max).c_str(), distance, setting_words(p).c_str());
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

// Everything that is made of a sweep: by the command and by a merge alike.
Exit conclude_accuracy(const Rows& all, const Scene& scene, const SweepPlan& plan, const AccuracyOptions& options) {
  std::vector<std::string> refused;
  settings_of(scene, plan, refused);
  const auto made = swept_of(all, std::move(refused));
  if (!made) return failed(made.error());
  const Swept& swept = *made;
  for (const std::string& note : swept.notes) std::printf("note: %s\n", note.c_str());
  if (swept.curve.points.empty()) return failed("No setting could be measured");

  std::vector<Shot> shots;
  if (!interrupted())
    if (const Exit exit = take_shots(scene, swept, options, shots); exit != kDone && exit != kInterrupted) return exit;
  const Drawing drawing = accuracy_plot(swept.curve);
  const Page page{swept.curve, plan, swept.notes, std::move(shots), !all.all()};
  const std::pair<const char*, std::string> files[] = {
      {"curve.csv", curve_csv(swept.curve)}, {"curve.svg", svg(drawing)}, {"curve.html", accuracy_page(page)}};
  for (const auto& [name, text] : files)
    if (const Result<void> written = write_text(options.out / name, text); !written) return failed(written.error());
  if (const Result<void> written = write_png(options.out / "curve.png", picture(drawing)); !written) return failed(written.error());
  const std::vector<std::uint32_t> largest_alone = {largest(swept.curve)};
  for (const bool tethers : plan.tethers)
    for (const std::uint32_t cells : options.sides.empty() ? largest_alone : plan.cells) print_front(swept.curve, cells, tethers);
  if (options.budget_ms) print_budget(swept.curve, plan.tethers.front(), *options.budget_ms);
  if (options.save) {
    const std::filesystem::path file = curve_file(swept.curve.device);
    if (const Result<void> written = write_text(file, curve_csv(condensed(swept.curve)), Link::replace); !written)
      return failed(written.error());
    std::printf("Saved for scenes whose solver is \"auto\": %s\n", file.string().c_str());
  }
  std::printf("Written: curve.csv, curve.svg, curve.png, curve.html in %s\n", options.out.string().c_str());
  return kDone;
}

std::vector<std::string> accuracy_files() {
  std::vector<std::string> names = {"curve.csv", "curve.svg", "curve.html", "curve.png"};
  for (std::size_t k = 1; k <= kMostShots; ++k) names.push_back(shot_name(k));
  return names;
}

// The pictures of three budgets need the scene, which parts name.
Exit merge_accuracy(const Rows& all, const std::filesystem::path& out) {
  AccuracyOptions options = options_of(all.work);
  options.out = out;
  const auto scene = load_subject(options.file, options.assignments, options.buffer_files);
  if (!scene || fingerprint_of(*scene, options.file) != all.work.of) {
    complain("The scene of this sweep, from which the pictures of three budgets are made, " +
             (scene ? "is another by now: " + options.file.string() : "cannot be read: " + scene.error()));
    return kBadInput;
  }
  return conclude_accuracy(all, *scene, plan_of(*scene, options), options);
}

}  // namespace

Exit accuracy(const AccuracyOptions& options) {
  Result<Scene> scene = load_subject(options.file, options.assignments, options.buffer_files);
  if (!scene) {
    complain(scene.error());
    return kBadInput;
  }
  if (!options.sides.empty() && std::ranges::none_of(scene->cloths, [](const Cloth& cloth) { return cloth.grid.has_value(); })) {
    complain("--sides: " + options.file.string() + " has no grid, and a mesh is as fine as it is");
    return kBadInput;
  }
  listen_for_interrupts();
  const std::vector<std::string> names = outputs_of("accuracy", options.farm.shard, accuracy_files());
  if (const Exit exit = prepare_outputs(options.out, names, inputs_of(options.file, *scene)); exit != kDone) return exit;
  compute::DeviceChoice choice;
  choice.name = options.device;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());

  if (options.save)
    if (const Result<void> place = prepare_to_save((*device)->name()); !place) return failed(place.error());

  const SweepPlan plan = plan_of(*scene, options);
  std::vector<std::string> refused;
  const std::vector<Setting> settings = settings_of(*scene, plan, refused);
  std::printf("%s on %s: %zu settings, %u frames each\n", scene->name.c_str(), (*device)->name().c_str(), settings.size(), plan.frames);
  std::error_code none;
  Work work{"accuracy", facts_of(options, plan, *scene, (*device)->name())};
  work.place = {{"file", std::filesystem::absolute(options.file, none).string()}, {"date", now()}};
  work.of = fingerprint_of(*scene, options.file);
  work.items = static_cast<std::uint32_t>(settings.size());
  Labour labour;
  labour.unit = "million particle passes";
  labour.kept = true;   // for other budgets
  labour.cost = [&](std::uint32_t item) { return units(settings[item]); };
  labour.measure = [&](std::uint32_t item) { return measure_row(**device, *scene, plan, settings[item], options.out); };
  labour.conclude = [&](const Rows& all) { return conclude_accuracy(all, *scene, plan, options); };
  return work_through(work, labour, options.farm, options.out);
}

Mergeable merged_accuracy() { return {"accuracy", accuracy_files(), merge_accuracy}; }

}  // namespace weft::command
