#include "samples/weft/effect_price.h"

#include <chrono>
#include <memory>

#include "samples/weft/console.h"

namespace weft::command {

namespace {

constexpr std::uint32_t kCounted = 8;   // frames whose dispatches are counted: which passes solve contacts depends on how many there are

Result<std::unique_ptr<Simulation>> start_of(const compute::Device& device, const Scene& scene, bool timings) {
  SimulationOptions options;
  options.timings = timings;
  return Simulation::create(device, scene, options);
}

Result<double> timed_frame(Simulation& simulation, double seconds) {
  const auto start = std::chrono::steady_clock::now();
  if (const auto advance = simulation.advance(seconds); !advance) return fail(advance.why());
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// With timestamps, which take time: not in the simulation that is timed.
Result<double> dispatches_of(const compute::Device& device, const Scene& scene, std::uint32_t frames) {
  auto simulation = start_of(device, scene, true);
  if (!simulation) return simulation.take_error();
  std::uint64_t dispatches = 0;
  for (std::uint32_t k = 0; k < frames; ++k) {
    if (const auto advance = (*simulation)->advance(1 / scene.solver.rate); !advance) return fail(advance.why());
    dispatches += (*simulation)->dispatch_times().size();
  }
  return static_cast<double>(dispatches) / frames;
}

}  // namespace

Result<EffectPrice> price_of(const compute::Device& device, const Scene& without, const Scene& with, std::uint32_t frames) {
  auto bare = start_of(device, without, false), full = start_of(device, with, false);
  if (!bare) return bare.take_error();
  if (!full) return full.take_error();
  std::vector<double> bare_ms, full_ms;
  for (std::uint32_t k = 0; k < frames && (k < 2 || !interrupted()); ++k)
    for (const auto& [simulation, ms] : {std::pair(bare->get(), &bare_ms), std::pair(full->get(), &full_ms)}) {
      const auto frame = timed_frame(*simulation, 1 / without.solver.rate);
      if (!frame) return fail(frame.why());
      if (k > 0) ms->push_back(*frame);
    }
  EffectPrice price;
  price.with = footprint_of(**full);
  price.without_ms = spread_of(std::move(bare_ms));
  price.with_ms = spread_of(std::move(full_ms));
  auto dispatches = dispatches_of(device, with, std::min(frames, kCounted));
  if (!dispatches) return dispatches.take_error();
  price.dispatches = *dispatches;
  return price;
}

}  // namespace weft::command
