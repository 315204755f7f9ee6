// Interpolating between measured resolutions, and choosing.
#include "engine/reference/choice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "compute/text.h"

namespace weft {
namespace {

using SettingKey = std::tuple<std::string, std::uint32_t, std::uint32_t>;
SettingKey key_of(const CurvePoint& point) { return {point.row, point.substeps, point.iterations}; }

// One setting's points by particles, ascending.
using Samples = std::vector<CurvePoint>;

CurvePoint expected(const Samples& samples, std::uint64_t particles) {
  const auto above = std::find_if(samples.begin(), samples.end(), [&](const CurvePoint& p) { return p.particles >= particles; });
  CurvePoint at = above == samples.begin() ? samples.front() : *(above - 1);
  if (above != samples.end() && above != samples.begin()) {
    const CurvePoint& low = *(above - 1);
    const double part = std::log(double(particles) / double(low.particles)) / std::log(double(above->particles) / double(low.particles));
    for (const CurveError figure : {&CurvePoint::ms_median, &CurvePoint::strain_rms})
      at.*figure = std::pow(std::max(low.*figure, 1e-12), 1 - part) * std::pow(std::max((*above).*figure, 1e-12), part);
  } else if (above == samples.end()) {
    at.ms_median *= double(particles) / double(at.particles);
  }
  at.particles = particles;
  return at;
}

// Plain averaging lets a free cloth drift, and second order in time does not go with all that a scene may have: they are on curves for
// comparison, and never chosen.
bool offered(const CurvePoint& point) {
  return point.assignments.find("averaging=count") == std::string::npos && point.assignments.find("order=2") == std::string::npos;
}

std::map<SettingKey, Samples> settings_of(const Curve& curve, bool tethers) {
  std::map<SettingKey, Samples> settings;
  for (const CurvePoint& point : curve.points)
    if (point.tethers == tethers && point.particles > 0 && offered(point) && counts(point, &CurvePoint::strain_rms))
      settings[key_of(point)].push_back(point);
  for (auto& [key, samples] : settings)
    std::sort(samples.begin(), samples.end(), [](const CurvePoint& a, const CurvePoint& b) { return a.particles < b.particles; });
  return settings;
}

// The solver settings of a curve's assignments, parsed by the rules for scenes.
Result<SolverSettings> solver_of(const CurvePoint& setting) {
  std::vector<Assignment> assignments;
  std::istringstream words(setting.assignments);
  words.exceptions(std::ios::badbit);   // a word for which there is no memory is none that may be left out
  for (std::string word; words >> word;)
    assignments.push_back({word.substr(0, word.find('=')), word.substr(std::min(word.find('=') + 1, word.size()))});
  assignments.push_back({"solver.substeps", std::to_string(setting.substeps)});
  assignments.push_back({"solver.iterations", std::to_string(setting.iterations)});
  // In curves of earlier versions jacobi is what assigns nothing.
  auto scene = parse_scene(R"({"solver": {"method": "jacobi"}, "cloths": [{"grid": {}}]})", {}, assignments);
  if (!scene) return fail("the curve's setting \"", setting.row, "\": ", scene.why());
  return scene->solver;
}

}  // namespace

Result<Choice> choose(const Curve& curve, double budget_ms, std::uint64_t particles, bool tethers,
                      const std::function<bool(const CurvePoint&)>& goes) try {
  const auto those_that_go = [&](bool held) {
    auto settings = settings_of(curve, held);
    std::erase_if(settings, [&](const auto& one) { return !goes(one.second.front()); });
    return settings;
  };
  auto settings = those_that_go(tethers);
  if (settings.empty()) settings = those_that_go(!tethers);
  if (settings.empty()) return fail("the curve of ", curve.scene, " on ", curve.device, " has no setting to choose from");
  std::vector<CurvePoint> points;
  for (const auto& [key, samples] : settings) points.push_back(expected(samples, particles));
  const auto found = best(points, &CurvePoint::strain_rms, budget_ms);
  return Choice{points[found ? *found : front(points, &CurvePoint::strain_rms).front()], found.has_value()};
} catch (...) {
  return caught("the curve");
}

Result<Scene> with_choice(const Scene& scene, std::uint64_t particles, const Curve& curve, std::string& note) try {
  if (scene.solver.method != Method::automatic) return scene;
  if (const std::string fault = order_fault(scene); !fault.empty()) return fail("solver.order: ", fault);
  if (!scene.solver.budget_ms) return fail("solver.method: \"auto\" needs solver.budget_ms");
  Scene chosen = scene;
  chosen.contacts.enabled = contacts_on(scene);   // no setting may turn them off
  const auto solve_by = [&](const CurvePoint& setting) -> Result<void> {
    auto solver = solver_of(setting);
    if (!solver) return solver.take_error();
    chosen.solver = *solver;
    chosen.solver.rate = scene.solver.rate;
    chosen.solver.longest_advance = scene.solver.longest_advance;
    return {};
  };
  // A setting that cannot be read counts as one that goes: whoever would get it is told.
  const auto choice = choose(curve, *scene.solver.budget_ms, particles, tethers_hold(scene), [&](const CurvePoint& setting) {
    return !solve_by(setting) || (method_fault(chosen).empty() && order_fault(chosen).empty() && relaxation_fault(chosen).empty());
  });
  if (!choice) return fail(choice.why());
  const CurvePoint& setting = choice->setting;
  if (const auto done = solve_by(setting); !done) return fail(done.why());
  note = "solver: " + setting.row + ", " + std::to_string(setting.substeps) + " substeps x " + std::to_string(setting.iterations) +
         " iterations: " + rounded_text(setting.ms_median, 3) + " ms and " + rounded_text(100 * setting.strain_rms, 2) +
         " % rms strain expected for " + std::to_string(particles) + " particles by the curve of " + curve.scene + " on " +
         curve.device + " of " + curve.date + (choice->fits ? "" : "; nothing fits the budget") +
         (*chosen.contacts.enabled ? "; contacts take their own time on top." : ".");
  return chosen;
} catch (...) {
  return caught("the curve");
}

Curve condensed(const Curve& curve) {
  std::set<std::pair<bool, SettingKey>> kept;
  std::set<std::pair<std::uint32_t, bool>> parts;
  for (const CurvePoint& point : curve.points) parts.insert({point.cells, point.tethers});
  for (const auto& [cells, tethers] : parts) {
    const auto points = points_of(curve, cells, tethers);
    for (const std::size_t i : front(points, &CurvePoint::strain_rms)) kept.insert({tethers, key_of(points[i])});
  }
  Curve small = curve;
  std::erase_if(small.points, [&](const CurvePoint& point) { return !kept.contains({point.tethers, key_of(point)}); });
  for (CurvePoint& point : small.points) {
    point.passes.clear();
    for (const CurveError figure : {&CurvePoint::ms_p95, &CurvePoint::ms_gpu, &CurvePoint::strain_mean, &CurvePoint::strain_max,
                                    &CurvePoint::solver_error, &CurvePoint::time_error, &CurvePoint::total_error})
      point.*figure = CurvePoint::kUnknown;
  }
  return small;
}

}  // namespace weft
