// Medians, CSV and JSON.
#include "samples/weft/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "compute/text.h"

namespace weft::command {

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t count = values.size();
  const double median = count % 2 == 1 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / 2;
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(count)));
  return {median, values[rank - 1]};
}

PassTimes::PassTimes(std::vector<PassUse> passes, std::uint32_t first) : passes_(std::move(passes)), first_(first), dispatches_(passes_.size()) {
  for (std::size_t i = 0; i < passes_.size(); ++i) column_[passes_[i].name] = i;
}

void PassTimes::add_frame(const std::vector<PassTiming>& timings) {
  std::vector<double>& row = rows_.emplace_back(passes_.size(), 0.0);
  for (const PassTiming& timing : timings) {
    const auto found = column_.find(timing.name);
    if (found == column_.end()) continue;
    row[found->second] += timing.milliseconds;
    dispatches_[found->second] += timing.dispatches;
  }
}

double PassTimes::dispatches(std::size_t pass) const {
  if (rows_.empty()) return passes_[pass].dispatches_per_frame;
  return static_cast<double>(dispatches_[pass]) / static_cast<double>(rows_.size());
}

Spread PassTimes::spread(std::size_t pass) const {
  std::vector<double> values;
  for (const std::vector<double>& row : rows_) values.push_back(row[pass]);
  return spread_of(std::move(values));
}

Spread PassTimes::total() const {
  std::vector<double> values;
  for (const std::vector<double>& row : rows_) {
    double sum = 0;
    for (const double value : row) sum += value;
    values.push_back(sum);
  }
  return spread_of(std::move(values));
}

std::string PassTimes::csv() const {
  TextStream text;
  text.precision(6);
  text << "frame";
  for (const PassUse& pass : passes_) text << ',' << pass.name;
  text << '\n';
  for (std::size_t frame = 0; frame < rows_.size(); ++frame) {
    text << first_ + frame;
    for (const double value : rows_[frame]) text << ',' << value;
    text << '\n';
  }
  return text.str();
}

double fastest_of(const CookedFabric& fabric, std::span<const gpu::vec4> before, std::span<const gpu::vec4> after, double seconds) {
  double farthest = 0;
  for (std::size_t i = 0; i < cloth_particles(fabric); ++i) {
    const gpu::vec4 &a = before[i], &b = after[i];
    farthest = std::max(farthest, std::hypot(double(b.x) - a.x, double(b.y) - a.y, double(b.z) - a.z));
  }
  return farthest / seconds;
}

Result<Figures> figures_of(const Simulation& simulation) {
  const Result<std::vector<gpu::vec4>> positions = simulation.read_positions();
  if (!positions) return fail(positions.why());
  const CookedFabric& fabric = simulation.fabric();
  Figures figures;
  figures.scene = simulation.scene().name;
  figures.device = simulation.device().name();
  figures.timed_on_cpu = simulation.timed_on_cpu();
  figures.particles = cloth_particles(fabric);
  figures.edges = fabric.links.size();
  figures.counts = simulation.counts();
  figures.cooked = cooked_figures(simulation.scene(), fabric);
  figures.counted = counted_figures(simulation.scene(), fabric, figures.counts);
  figures.remarks = remarks_on(simulation.scene(), fabric, figures.counts);
  figures.mesh_colliders = !fabric.collider_meshes.empty();
  figures.buffers = simulation.buffers();
  figures.strain = measure_strain(fabric, *positions);
  figures.hash = position_hash(*positions);
  return figures;
}

namespace {

using Json = nlohmann::ordered_json;

// What was not measured is null, never zero.
Json milliseconds(const std::optional<Spread>& spread) {
  if (!spread) return {{"ms_median", nullptr}, {"ms_p95", nullptr}};
  return {{"ms_median", spread->median}, {"ms_p95", spread->p95}};
}

void put(Json& report, const std::vector<FigureValue>& figures) {
  for (const auto& [name, value] : figures) {
    const std::size_t dot = name.find('.');
    Json& entry = dot == std::string_view::npos ? report[std::string(name)]
                                                : report[std::string(name.substr(0, dot))][std::string(name.substr(dot + 1))];
    std::visit([&](auto number) { entry = number; }, value);
  }
}

}  // namespace

std::string report_json(const Figures& figures, const PassTimes& times) {
  // JSON's numbers hold 53 bits; a hash is text.
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(figures.hash));

  Json report;
  report["scene"] = figures.scene;
  report["device"] = figures.device;
  report["frames"] = figures.frames;
  report["interrupted"] = figures.interrupted;
  if (figures.resumed_at) report["resumed_at"] = *figures.resumed_at;
  report["particles"] = figures.particles;
  report["edges"] = figures.edges;
  put(report, figures.cooked);
  report["timed_on_cpu"] = figures.timed_on_cpu;
  report["timed"] = {{"first", times.first_frame()}, {"frames", times.frames()}};
  report["passes"] = Json::array();
  for (std::size_t i = 0; i < times.passes().size(); ++i) {
    const PassUse& pass = times.passes()[i];
    Json& entry = report["passes"].emplace_back(Json{{"name", pass.name}, {"dispatches", times.dispatches(i)}});
    entry.update(milliseconds(times.frames() > 0 ? std::optional(times.spread(i)) : std::nullopt));
  }
  report["buffers"] = Json::array();
  for (const BufferUse& buffer : figures.buffers) report["buffers"].push_back({{"name", buffer.name}, {"bytes", buffer.bytes}});
  report["frame"] = milliseconds(figures.frame);
  report["strain"] = {{"mean", figures.strain.mean}, {"rms", figures.strain.rms}, {"max", figures.strain.max}};
  if (figures.speed) report["speed"] = *figures.speed;
  report["non_finite"] = figures.counts.non_finite;
  report["coincident"] = figures.counts.coincident;
  if (figures.intersections) report["intersections"] = {{"max", figures.intersections->max}, {"final", figures.intersections->final}};
  put(report, figures.counted);
  report["clamped_seconds"] = figures.clamped_seconds;
  report["hash"] = hash;
  constexpr int kIndent = 2;
  return report.dump(kIndent, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace weft::command
