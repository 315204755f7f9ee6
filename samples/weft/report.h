// Times and figures of a run, as files: timings.csv and report.json.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/figures.h"
#include "engine/metrics.h"
#include "engine/simulation.h"

namespace weft::command {

/// The middle value and the one that 95 % stay below (nearest rank); zero of an empty list.
struct Spread {
  double median = 0, p95 = 0;
};
Spread spread_of(std::vector<double> values);

/// Milliseconds of every pass in every frame.
class PassTimes {
 public:
  /// `first`: which of the scene's frames the first one is.
  explicit PassTimes(std::vector<PassUse> passes, std::uint32_t first = 0);

  void add_frame(const std::vector<PassTiming>& timings);

  const std::vector<PassUse>& passes() const { return passes_; }
  std::uint32_t first_frame() const { return first_; }
  std::size_t frames() const { return rows_.size(); }
  /// Dispatches a frame, the mean of those that were timed: which passes solve contacts depends on how many there are. Before any was: of a
  /// frame that has them all.
  double dispatches(std::size_t pass) const;
  Spread spread(std::size_t pass) const;
  /// The sum of all passes, frame by frame.
  Spread total() const;
  /// A line a frame, a column a pass, milliseconds.
  std::string csv() const;

 private:
  std::vector<PassUse> passes_;
  std::uint32_t first_ = 0;
  std::map<std::string, std::size_t> column_;
  std::vector<std::vector<double>> rows_;
  std::vector<std::uint64_t> dispatches_;   // of all frames
};

/// Pairs of edge and triangle, of cloth and cloth or cloth and mesh collider, that cross (engine/reference/intersections.h), at the
/// start and after every frame.
struct Intersections {
  std::uint64_t max = 0;     // of all of these
  std::uint64_t final = 0;
};

/// What report.json says besides the pass times.
struct Figures {
  std::string scene, device;
  std::uint32_t frames = 0;      // that were simulated
  std::optional<std::uint32_t> resumed_at;   // the first that this program simulated, where it went on with a checkpoint
  bool interrupted = false;
  bool timed_on_cpu = false;     // no timestamps on this device
  std::size_t particles = 0, edges = 0;   // of cloth
  std::vector<FigureValue> cooked, counted;   // of the scene's effects
  std::vector<std::string> remarks;
  bool mesh_colliders = false;   // whether the scene has them
  std::vector<BufferUse> buffers;
  std::optional<Spread> frame;   // ms, whole frames without timestamps; none when no frame was timed
  Strain strain;
  Counts counts;
  double clamped_seconds = 0;
  std::optional<double> speed;   // m/s, of the fastest particle over the last frame; none unless that was simulated
  std::uint64_t hash = 0;
  std::optional<Intersections> intersections;   // none unless they were counted
};

/// m/s, of the fastest particle of cloth that takes `seconds` from one position to the other. This is the speed that is seen: the
/// velocities of substeps also have the rounding of positions.
double fastest_of(const CookedFabric& fabric, std::span<const gpu::vec4> before, std::span<const gpu::vec4> after, double seconds);

/// Everything about a simulation's state but times. Waits for it.
Result<Figures> figures_of(const Simulation& simulation);

std::string report_json(const Figures& figures, const PassTimes& times);

}  // namespace weft::command
