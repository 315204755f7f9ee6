// Benchmarks against the yardstick, as ratios in one run: machines are noisy, so both sides take turns within each
// measurement. `weft_bench` alone prints all; --benchmark_filter picks.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "compute/commands.h"
#include "engine/simulation.h"
#include "engine/solve/solver.h"
#include "tests/bench/need.h"
#include "tests/bench/yardstick.h"
#include "tests/support/without_contacts.h"

namespace weft::bench {
namespace {

constexpr int kPasses = 40;

// A sheet of n x n vertices hung from its two upper corners, with links as rigid as those of the engines it is compared with.
Scene hung_sheet(std::uint32_t n) {
  Scene scene = without_contacts();
  Cloth cloth;
  cloth.grid = Grid{{10, 10}, n - 1, n - 1, Topology::diagonal, true};
  cloth.fabric = *fabric_preset("cotton");
  cloth.fabric.stretch = cloth.fabric.shear = INFINITY;
  Anchor anchor;
  anchor.corners = {Corner::low_high, Corner::high_high};
  cloth.anchors.push_back(anchor);
  scene.cloths.push_back(cloth);
  return scene;
}

const compute::Device& device() {
  static const std::unique_ptr<compute::Device> device = need(compute::Device::create());
  return *device;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

// Cloth that somebody simulates is not at rest; at the fixed point of its passes a sheet of 200 x 200 runs 10 % slower than one
// of 199 x 199 or 201 x 201, and than itself a centimetre off.
void stir(CookedFabric& fabric) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> offset(-0.005f, 0.005f);   // m, a tenth of an edge at 200 x 200
  for (gpu::vec4& p : fabric.positions) p = {p.x + offset(random), p.y + offset(random), p.z + offset(random), p.w};
}

// The stretch pass alone, many times in one submit, against the same number of yardstick passes. Second argument: gather
// through storage buffers.
void stretch_pass(benchmark::State& state) {
  Scene scene = hung_sheet(static_cast<std::uint32_t>(state.range(0)));
  scene.cloths[0].bending = true;   // so that stretch stands alone, without settling
  CookedFabric fabric = need(cook(scene, need(make_meshes(scene))));
  stir(fabric);
  const auto cache = need(compute::PipelineCache::create(device()));
  Solver solver = need(Solver::create(device(), cache, scene, fabric, {.gather_storage = state.range(1) != 0}));
  FrameInput input;
  input.substeps = 1;
  input.gravity = scene.gravity;
  const auto steps = solver.frame(input);
  const auto stretch =
      std::find_if(steps.begin(), steps.end(), [&](const Solver::Step& s) { return solver.plan().passes[s.pass].label == "stretch"; });
  const auto run = [&] {
    const auto recorded = compute::run_once(device(), "stretch", [&](VkCommandBuffer commands) {
      compute::Recorder recorder(device(), commands);
      Solver::Step step = *stretch;
      for (int pass = 0; pass < kPasses; ++pass, step.parity ^= 1) solver.record_step(recorder, step);
      recorder.finish();
    });
    if (!recorded) std::exit(1);
  };
  const Csr csr = csr_of(fabric);
  std::vector<gpu::vec4> from = fabric.positions, to = fabric.positions;
  for (std::size_t i = 0; i < from.size(); ++i) from[i].w = to[i].w = fabric.split_weights[i];
  run();
  std::vector<double> yardstick, pass;
  for ([[maybe_unused]] auto _ : state) {
    yardstick.push_back(run_yardstick(csr, from, to, 1 / static_cast<float>(fabric.h * fabric.h), 1, kPasses));
    const auto start = std::chrono::steady_clock::now();
    run();
    pass.push_back(seconds_since(start));
  }
  const double links = static_cast<double>(fabric.links.size()) * kPasses / 1e6;
  state.counters["yardstick_Mlinks/s"] = links / median(yardstick);
  state.counters["pass_Mlinks/s"] = links / median(pass);
  state.counters["pass_over_yardstick"] = median(yardstick) / median(pass);
}

// A whole frame at the default settings, in yardstick passes.
void default_frame(benchmark::State& state) {
  const Scene scene = hung_sheet(static_cast<std::uint32_t>(state.range(0)));
  const auto simulation = need(Simulation::create(device(), scene));
  const CookedFabric& fabric = simulation->fabric();
  const Csr csr = csr_of(fabric);
  std::vector<gpu::vec4> from = fabric.positions, to = fabric.positions;
  for (std::size_t i = 0; i < from.size(); ++i) from[i].w = to[i].w = fabric.split_weights[i];
  for (int warm_up = 0; warm_up < 5; ++warm_up) (void)simulation->advance(1 / scene.solver.rate);
  std::vector<double> yardstick, frame;
  for ([[maybe_unused]] auto _ : state) {
    yardstick.push_back(run_yardstick(csr, from, to, 1 / static_cast<float>(fabric.h * fabric.h), 1, kPasses) / kPasses);
    const auto start = std::chrono::steady_clock::now();
    (void)simulation->advance(1 / scene.solver.rate);
    frame.push_back(seconds_since(start));
  }
  state.counters["frame_ms"] = 1e3 * median(frame);
  state.counters["yardstick_ms"] = 1e3 * median(yardstick);
  state.counters["frame_in_yardsticks"] = median(frame) / median(yardstick);
  state.counters["ns/particle"] = 1e9 * median(frame) / static_cast<double>(fabric.positions.size());
}

BENCHMARK(stretch_pass)->ArgNames({"n", "storage"})->ArgsProduct({{100, 200, 300}, {0, 1}})->Unit(benchmark::kMillisecond)->Iterations(40);
BENCHMARK(default_frame)->Arg(100)->Arg(200)->Arg(300)->Unit(benchmark::kMillisecond)->Iterations(60);

}  // namespace
}  // namespace weft::bench

BENCHMARK_MAIN();
