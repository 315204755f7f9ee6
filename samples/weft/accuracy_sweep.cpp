// Settings and their measurement.
#include "samples/weft/accuracy_sweep.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "compute/text.h"
#include "engine/reference/errors.h"
#include "engine/simulation.h"
#include "samples/weft/accuracy_reference.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/report.h"

namespace weft::command {

namespace {

using Clock = std::chrono::steady_clock;

// A name with a comma would not be found again in a CSV.
static_assert(std::all_of(std::begin(kSolverRows), std::end(kSolverRows), [](const SolverRow& row) {
  return row.name.find(',') == row.name.npos && row.assignments.find(',') == row.assignments.npos;
}));

constexpr std::uint32_t kTimedByStamps = 12, kBeforeStamps = 3;   // frames
constexpr double kSubmission = 4000;   // what a frame costs besides its passes, in particles of one pass

std::vector<Assignment> assignments_of(std::string_view text) {
  std::vector<Assignment> list;
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word;) list.push_back({word.substr(0, word.find('=')), word.substr(word.find('=') + 1)});
  return list;
}

Result<Scene> changed(const Scene& scene, std::span<const Assignment> assignments) {
  auto made = parse_scene(scene_text(scene), scene.folder, assignments);
  if (made) made->name = scene.name;
  return made;
}

std::uint32_t longest_side(const Scene& scene) {
  std::uint32_t most = 0;
  for (const Cloth& cloth : scene.cloths)
    if (cloth.grid) most = std::max({most, cloth.grid->cells_x, cloth.grid->cells_y});
  return most;
}

double particles_at(const Scene& scene) {
  double sum = 0;
  for (const Cloth& cloth : scene.cloths)
    if (cloth.grid) sum += (cloth.grid->cells_x + 1.0) * (cloth.grid->cells_y + 1.0) * (cloth.grid->topology == Topology::centre ? 2 : 1);
  return std::max(sum, 100.0);   // what meshes have is not known here
}

// Sums of a strain over frames.
struct StrainSum {
  Strain sum;
  std::size_t frames = 0;

  void add(const Strain& s) {
    sum.mean += s.mean;
    sum.rms += s.rms * s.rms;
    sum.max = std::isfinite(s.max) ? std::max(sum.max, s.max) : s.max;
    ++frames;
  }
  Strain value() const {
    const auto n = static_cast<double>(std::max<std::size_t>(frames, 1));
    return {sum.mean / n, std::sqrt(sum.rms / n), sum.max};
  }
};

// At the setting's own step, and at a sixteenth of it; of no poses where there is no reference.
struct References {
  reference::Trajectory same, fine;
  bool there() const { return !same.poses.empty(); }
};

Result<References> references_of(const Scene& scene, const Setting& setting, const SweepPlan& plan, const std::filesystem::path& folder) {
  const auto base = scene_at(scene, setting.cells, setting.tethers);
  if (!base) return fail(base.why());
  auto same = reference_run(*base, setting.substeps, plan.frames, folder);
  if (!same) return same.take_error();
  auto fine = reference_run(*base, std::min(16 * setting.substeps, plan.most_steps), plan.frames, folder);
  if (!fine) return fine.take_error();
  return References{std::move(*same), std::move(*fine)};
}

// Errors and whole frames.
Result<void> run(const compute::Device& device, const Scene& scene, const SweepPlan& plan, const References& references,
                 CurvePoint& point) {
  SimulationOptions options;
  options.pipeline_cache = pipeline_cache();
  auto simulation = Simulation::create(device, scene, options);
  if (!simulation) return simulation.take_error();
  const CookedFabric& fabric = (*simulation)->fabric();
  reference::Trajectory poses;
  StrainSum strains;
  std::vector<double> wall;
  for (std::uint32_t frame = 0; frame < plan.frames && !interrupted(); ++frame) {
    const Clock::time_point start = Clock::now();
    if (auto advance = (*simulation)->advance(1 / scene.solver.rate); !advance) return fail("frame ", frame, ": ", advance.why());
    if (frame >= plan.warm_up) wall.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    const bool strained = 2 * (frame + 1) > plan.frames;
    if (!strained && !references.there()) continue;
    const auto positions = (*simulation)->read_positions();
    if (!positions) return fail(positions.why());
    if (strained) strains.add(measure_strain(fabric, *positions));
    if (references.there()) poses.poses.push_back(reference::pose_of(fabric, *positions));
  }
  const Spread spread = spread_of(wall);
  const Strain strain = strains.value();
  point.particles = cloth_particles(fabric);
  point.ms_median = spread.median;
  point.ms_p95 = spread.p95;
  point.strain_mean = strain.mean;
  point.strain_rms = strain.rms;
  point.strain_max = strain.max;
  point.non_finite = (*simulation)->counts().non_finite;
  if (references.there()) {
    const double size = reference::sheet_size(fabric);
    // Its steps are of first order: at one step h of second order it is another integrator's.
    if (scene.solver.order == 1) point.solver_error = reference::run_error(poses, references.same, size);
    point.time_error = reference::run_error(references.same, references.fine, size);
    point.total_error = reference::run_error(poses, references.fine, size);
  }
  return {};
}

// Passes by timestamps, in a simulation of its own: timestamps cost time themselves.
Result<void> time_passes(const compute::Device& device, const Scene& scene, CurvePoint& point) {
  SimulationOptions options;
  options.timings = true;
  options.pipeline_cache = pipeline_cache();
  auto simulation = Simulation::create(device, scene, options);
  if (!simulation) return simulation.take_error();
  PassTimes times((*simulation)->passes());
  for (std::uint32_t frame = 0; frame < kBeforeStamps + kTimedByStamps && !interrupted(); ++frame) {
    if (auto advance = (*simulation)->advance(1 / scene.solver.rate); !advance) return advance.take_error();
    if (frame >= kBeforeStamps) times.add_frame((*simulation)->timings());
  }
  TextStream passes;
  passes.precision(4);
  for (std::size_t i = 0; i < times.passes().size(); ++i)
    passes << (i > 0 ? " " : "") << times.passes()[i].name << '=' << times.spread(i).median;
  point.passes = passes.str();
  point.ms_gpu = times.total().median;
  point.dispatches = 0;
  for (std::size_t i = 0; i < times.passes().size(); ++i) point.dispatches += times.dispatches(i);
  return {};
}

}  // namespace

bool Setting::operator==(const CurvePoint& point) const {
  return point.row == row.name && point.cells == cells && point.tethers == tethers && point.substeps == substeps &&
         point.iterations == iterations;
}

Result<Scene> scene_at(const Scene& scene, std::uint32_t cells, bool tethers) {
  std::vector<Assignment> assignments;
  const double scale = cells / std::max<double>(longest_side(scene), 1);
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) {
    const Cloth& cloth = scene.cloths[i];
    const std::string path = "cloths[" + std::to_string(i) + "].";
    const auto scaled = [&](std::uint32_t count) { return std::to_string(std::max<long>(1, std::lround(count * scale))); };
    if (cloth.grid && cells > 0)
      assignments.push_back({path + "grid.cells", '[' + scaled(cloth.grid->cells_x) + ',' + scaled(cloth.grid->cells_y) + ']'});
    if (cloth.tethers != tethers) assignments.push_back({path + "tethers", tethers ? "true" : "false"});
  }
  return changed(scene, assignments);
}

Result<Scene> scene_of(const Scene& scene, const Setting& setting) {
  auto base = scene_at(scene, setting.cells, setting.tethers);
  if (!base) return base;
  std::vector<Assignment> assignments = assignments_of(setting.row.assignments);
  assignments.push_back({"solver.substeps", std::to_string(setting.substeps)});
  assignments.push_back({"solver.iterations", std::to_string(setting.iterations)});
  return changed(*base, assignments);
}

std::vector<Setting> settings_of(const Scene& scene, const SweepPlan& plan, std::vector<std::string>& refused) {
  std::vector<Setting> settings;
  for (const SolverRow& row : kSolverRows) {
    const std::size_t before = settings.size();
    std::string why;
    for (const std::uint32_t cells : plan.cells)
      for (const bool tethers : plan.tethers) {
        const auto base = scene_at(scene, cells, tethers);
        const double particles = base ? particles_at(*base) : 1;
        for (const std::uint32_t substeps : plan.substeps)
          for (const std::uint32_t iterations : plan.iterations) {
            const std::uint32_t passes = substeps * iterations;
            if (passes > (iterations == 1 ? plan.most_passes : plan.most_iterated)) continue;
            if (passes > plan.free_passes && passes * particles > plan.most_particle_passes) continue;
            const double cost = (particles * passes + kSubmission) * (plan.frames + kBeforeStamps + kTimedByStamps);
            Setting setting{row, cells, tethers, substeps, iterations, cost};
            if (const auto made = scene_of(scene, setting)) settings.push_back(setting);
            else why = made.error();
          }
      }
    if (settings.size() == before) refused.push_back(std::string(row.name) + ": " + why);
  }
  std::stable_sort(settings.begin(), settings.end(), [](const Setting& a, const Setting& b) { return a.work < b.work; });
  return settings;
}

Result<CurvePoint> measure(const compute::Device& device, const Scene& scene, const Setting& setting, const SweepPlan& plan,
                           const std::filesystem::path& folder, std::string& no_reference) {
  auto made = scene_of(scene, setting);
  if (!made) return made.take_error();
  CurvePoint point;
  point.row = setting.row.name;
  point.assignments = setting.row.assignments;
  point.cells = setting.cells;
  point.tethers = setting.tethers;
  point.substeps = setting.substeps;
  point.iterations = setting.iterations;

  References references;
  if (no_reference.empty() && setting.cells <= plan.reference_cells) {
    auto found = references_of(scene, setting, plan, folder);
    if (interrupted()) return fail("interrupted");
    if (found) references = std::move(*found);
    else no_reference = found.error();
  }
  if (auto done = run(device, *made, plan, references, point); !done) return done.take_error();
  if (auto done = time_passes(device, *made, point); !done) return done.take_error();
  if (interrupted()) return fail("interrupted");
  return point;
}

}  // namespace weft::command
