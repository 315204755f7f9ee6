// Whether vertex block descent earns a place among the solvers: error and strain of it (on the processor, in double precision) beside
// the device's Gauss-Seidel, both by colours, at the same substeps. What counts are the counters, in percent; not the times.
//   weft_bench --benchmark_filter=vbd
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "engine/reference/errors.h"
#include "engine/reference/vbd.h"
#include "engine/simulation.h"
#include "tests/bench/need.h"
#include "tests/support/without_contacts.h"

namespace weft::bench {
namespace {

enum Solver : std::int64_t { kGaussSeidel, kVbd, kAugmented };
enum Sheet : std::int64_t { kRigid10m, kCotton10m, kCotton1m };
constexpr std::uint32_t kFrames = 48;

// 33 x 33 particles, dropped from the horizontal into two corners, without tethers.
Scene falling_sheet(Sheet sheet, std::uint32_t substeps) {
  Scene scene = without_contacts();
  scene.solver.method = Method::gauss_seidel;
  scene.solver.substeps = substeps;
  Cloth& cloth = scene.cloths.emplace_back();
  const float side = sheet == kCotton1m ? 1 : 10;
  cloth.grid = Grid{{side, side}, 32, 32, Topology::diagonal, false};
  if (sheet == kRigid10m) cloth.fabric.stretch = cloth.fabric.shear = INFINITY;
  cloth.tethers = false;
  cloth.anchors.emplace_back().corners = {Corner::low_low, Corner::high_low};
  return scene;
}

reference::Trajectory run_on_device(const Scene& scene) {
  static const std::unique_ptr<compute::Device> device = need(compute::Device::create());
  const auto simulation = need(Simulation::create(*device, scene));
  reference::Trajectory run;
  for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
    need(simulation->advance(1 / scene.solver.rate));
    run.poses.push_back(reference::pose_of(simulation->fabric(), need(simulation->read_positions())));
  }
  return run;
}

const reference::Trajectory& reference_of(Sheet sheet, std::uint32_t substeps, const Scene& scene, const CookedFabric& fabric) {
  static std::map<std::pair<Sheet, std::uint32_t>, reference::Trajectory> made;
  auto found = made.find({sheet, substeps});
  if (found == made.end())
    found = made.emplace(std::pair(sheet, substeps), need(reference::integrate_newton(scene, fabric, kFrames, {.h = fabric.h}))).first;
  return found->second;
}

void vbd(benchmark::State& state) {
  const auto sheet = static_cast<Sheet>(state.range(0));
  const auto substeps = static_cast<std::uint32_t>(state.range(1)), sweeps = static_cast<std::uint32_t>(state.range(3));
  Scene scene = falling_sheet(sheet, substeps);
  scene.solver.iterations = sweeps;
  const CookedFabric fabric = need(cook(scene, need(make_meshes(scene))));
  const reference::Trajectory& exact = reference_of(sheet, substeps, scene, fabric);
  reference::Trajectory run;
  for ([[maybe_unused]] auto _ : state)
    run = state.range(2) == kGaussSeidel
              ? run_on_device(scene)
              : need(reference::integrate_vbd(scene, fabric, kFrames, {.sweeps = sweeps, .augmented = state.range(2) == kAugmented}))
                    .trajectory;
  // Strain over the second half, in which it hangs and swings.
  double squares = 0, most = 0;
  for (std::size_t k = kFrames / 2; k < kFrames; ++k) {
    const Strain strain = reference::measure_strain(fabric, run.poses[k]);
    squares += strain.rms * strain.rms / (kFrames - kFrames / 2);
    most = std::max(most, strain.max);
  }
  state.counters["error"] = 100 * reference::run_error(run, exact, reference::sheet_size(fabric));
  state.counters["rms_strain"] = 100 * std::sqrt(squares);
  state.counters["max_strain"] = 100 * most;
}

BENCHMARK(vbd)->ArgNames({"sheet", "substeps", "solver", "sweeps"})
    ->ArgsProduct({{kRigid10m}, {10, 20}, {kGaussSeidel, kVbd, kAugmented}, {1, 2}})
    ->ArgsProduct({{kCotton10m, kCotton1m}, {10, 40}, {kGaussSeidel, kVbd}, {1, 2}})
    ->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace weft::bench
