// `weft time`: where a frame's time goes, pass by pass, without a window.
//
// Warm-up frames are run and forgotten; then frames with a timestamp pair around every dispatch; then as many in a second
// simulation without any, for the time of whole frames, in which the timestamps have no part.
#include <chrono>
#include <cstdio>

#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/outputs.h"
#include "samples/weft/report.h"
#include "samples/weft/subject.h"
#include "samples/weft/trace.h"

namespace weft::command {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kMostTraced = 100;  // frames: a trace of more is too large to be looked at

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Calls `each` after every frame that counts, with its wall time in milliseconds. Returns the seconds that were not simulated.
template <class F>
Result<double> advance_frames(Simulation& simulation, const TimeOptions& options, const char* what, F&& each) {
  double clamped = 0;
  Progress progress(what, options.warm_up + options.frames);
  for (std::uint32_t frame = 0; frame < options.warm_up + options.frames && !interrupted(); ++frame) {
    const Clock::time_point start = Clock::now();
    const Result<Advance> advance = simulation.advance(1 / simulation.scene().solver.rate);
    if (!advance) return fail("frame ", frame, ": ", advance.why());
    clamped += advance->clamped;
    if (frame >= options.warm_up) each(1000 * seconds_since(start));
    progress.step();
  }
  return clamped;
}

void print_table(const PassTimes& times) {
  const double total = times.total().median;
  double dispatches = 0;
  std::printf("%-24s %10s %12s %12s %8s\n", "pass", "dispatches", "median ms", "p95 ms", "share");
  for (std::size_t i = 0; i < times.passes().size(); ++i) {
    const PassUse& pass = times.passes()[i];
    const Spread spread = times.spread(i);
    std::printf("%-24s %10.4g %12.4f %12.4f %6.1f %%\n", pass.name.c_str(), times.dispatches(i), spread.median, spread.p95,
                total > 0 ? 100 * spread.median / total : 0);
    dispatches += times.dispatches(i);
  }
  std::printf("%-24s %10.4g %12.4f %12.4f\n", "all passes", dispatches, total, times.total().p95);
}

void print_frame(const Figures& figures, const Spread& frame, double create_seconds) {
  std::uint64_t bytes = 0;
  for (const BufferUse& buffer : figures.buffers) bytes += buffer.bytes;
  const auto particles = static_cast<double>(figures.particles);
  std::printf("%-24s %10s %12.4f %12.4f   wall clock, without timestamps\n", "whole frame", "", frame.median, frame.p95);
  std::printf("%zu particles: %.4g us and %.4g bytes each; cooked and created in %.3g s\n", figures.particles,
              1000 * frame.median / particles, static_cast<double>(bytes) / particles, create_seconds);
  std::printf("strain: mean %.4g %%, rms %.4g %%, max %.4g %%; not finite: %u\n", 100 * figures.strain.mean, 100 * figures.strain.rms,
              100 * figures.strain.max, figures.counts.non_finite);
  if (figures.clamped_seconds > 0)
    std::printf("%.3g s were not simulated: solver.longest_advance is shorter than a frame\n", figures.clamped_seconds);
  if (figures.timed_on_cpu) std::printf("This device has no timestamps: passes were timed on the CPU\n");
}

}  // namespace

Exit time(const TimeOptions& options) {
  const Result<Scene> scene = load_subject(options.file, options.assignments, options.buffer_files);
  if (!scene) {
    complain(scene.error());
    return kBadInput;
  }
  listen_for_interrupts();
  const std::string names[] = {"timings.csv", "trace.json", "report.json"};
  if (const Exit exit = prepare_outputs(options.out, names, inputs_of(options.file, *scene)); exit != kDone) return exit;
  compute::DeviceChoice choice;
  choice.name = options.device;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());

  const Clock::time_point before = Clock::now();
  const Started timed = start(**device, *scene, true);
  if (!timed.simulation) return timed.exit;
  const double create_seconds = seconds_since(before);
  Simulation& simulation = *timed.simulation;
  std::printf("%s on %s: %u frames after %u to warm up\n", scene->name.c_str(), (*device)->name().c_str(), options.frames, options.warm_up);
  std::fflush(stdout);

  PassTimes times(simulation.passes(), options.warm_up);
  std::vector<TracedFrame> traced;
  const Result<double> passes = advance_frames(simulation, options, "timing passes", [&](double) {
    times.add_frame(simulation.timings());
    if (traced.size() < kMostTraced) traced.push_back({simulation.gpu_milliseconds(), simulation.dispatch_times()});
  });
  if (!passes) return failed(passes.error());

  const Started plain = start(**device, *scene, false);
  if (!plain.simulation) return plain.exit;
  std::vector<double> wall;
  const Result<double> frames = advance_frames(*plain.simulation, options, "timing whole frames", [&](double ms) { wall.push_back(ms); });
  if (!frames) return failed(frames.error());

  Result<Figures> figures = figures_of(simulation);
  if (!figures) return failed(figures.error());
  figures->frames = options.warm_up + static_cast<std::uint32_t>(times.frames());
  figures->interrupted = interrupted();
  figures->clamped_seconds = *passes;
  if (!wall.empty()) figures->frame = spread_of(wall);
  print_table(times);
  print_frame(*figures, spread_of(wall), create_seconds);

  const std::pair<const char*, std::string> files[] = {{"timings.csv", times.csv()},
                                                       {"trace.json", trace_json((*device)->name(), simulation.passes(), traced)},
                                                       {"report.json", report_json(*figures, times)}};
  for (const auto& [name, text] : files)
    if (const Result<void> written = write_text(options.out / name, text); !written) return failed(written.error());
  std::printf("Written: timings.csv, trace.json (for ui.perfetto.dev), report.json in %s\n", options.out.string().c_str());
  if (!interrupted()) return kDone;
  return stopped(" after " + std::to_string(times.frames()) + " of " + std::to_string(options.frames) +
                 " frames: what is written is of these");
}

}  // namespace weft::command
