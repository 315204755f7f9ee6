// What a frame of the reference costs: a sheet of cotton, or rigid, dropped from the horizontal into two corners, over its first
// tenth of a second; at the engine's own substeps (10 a frame) and at a sixteenth of them.
//   weft_bench --benchmark_filter=reference
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "engine/reference/trajectory.h"
#include "tests/support/without_contacts.h"

namespace weft::bench {
namespace {

void reference_frame(benchmark::State& state) {
  constexpr std::uint32_t kFrames = 6;
  const auto cells = static_cast<std::uint32_t>(state.range(0) - 1);
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, cells, cells, Topology::diagonal, false};
  if (state.range(2) != 0) cloth.fabric.stretch = cloth.fabric.shear = INFINITY;
  cloth.tethers = false;
  cloth.anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};
  const auto meshes = make_meshes(scene);
  const auto fabric = cook(scene, *meshes);
  const double steps = static_cast<double>(state.range(1));
  for ([[maybe_unused]] auto _ : state) {
    const auto run = reference::integrate_newton(scene, *fabric, kFrames, {.h = 1 / (scene.solver.rate * steps)});
    if (!run) {
      std::fprintf(stderr, "weft_bench: %s\n", run.error().c_str());
      std::exit(1);
    }
    state.counters["newton_a_step"] = static_cast<double>(run->newton_steps) / (kFrames * steps);
    state.counters["not_converged"] = static_cast<double>(run->not_converged);
  }
  state.counters["s_a_frame"] = benchmark::Counter(kFrames, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(reference_frame)->ArgNames({"n", "steps", "rigid"})->Args({33, 10, 0})->Args({33, 160, 0})->Args({33, 10, 1})->Args({33, 160, 1})
    ->Args({100, 10, 0})->Args({100, 160, 0})->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace weft::bench
