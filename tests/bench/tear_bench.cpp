// What a frame that tears costs the CPU before its commands are recorded: the look at the cloth, the splits, and the cooking of the torn mesh.
// A sheet of so many cells a side, held along its top and drawn out across its middle row; with and without contacts.
//   weft_bench --benchmark_filter=tear
#include <benchmark/benchmark.h>

#include "engine/effects/tear/tear.h"
#include "tests/bench/need.h"
#include "tests/support/without_contacts.h"

namespace weft::bench {
namespace {

void tear(benchmark::State& state) {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  const auto cells = static_cast<std::uint32_t>(state.range(0));
  cloth.grid = Grid{{1, 1}, cells, cells, Topology::diagonal, true};
  cloth.tear = Tear{};
  cloth.anchors.emplace_back().top = 0.001;
  scene.contacts.enabled = state.range(1) != 0;
  std::vector<Mesh> meshes = need(make_meshes(scene));
  add_spares(scene, meshes);
  const CookedFabric fabric = need(cook(scene, meshes));
  std::vector<Eigen::Vector3d> places;
  for (const Vec3 p : meshes[0].points) places.emplace_back(p.x, p.y - (p.y < 0 ? 0.1 : 0), p.z);
  std::size_t splits = 0;
  for (auto _ : state) {
    std::vector<Mesh> torn = meshes;
    const auto found = cooking::cracks({torn[0], places, [](std::uint32_t) { return false; }}, fabric.own.of<TearLists>().limits[0]);
    splits = need(split_points(torn[0], found));
    benchmark::DoNotOptimize(need(torn_anew(scene, torn, fabric)));
  }
  state.counters["splits"] = static_cast<double>(splits);
}
BENCHMARK(tear)->ArgNames({"cells", "contacts"})->ArgsProduct({{32, 64, 100}, {0, 1}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace weft::bench
