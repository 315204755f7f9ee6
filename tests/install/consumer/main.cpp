// Runs a frame, knows a cache by its name, and asks what draws for a picture of nothing, which is refused.
#include "engine/cache.h"
#include "engine/shading/shading.h"
#include "engine/simulation.h"

int main() {
  auto device = weft::compute::Device::create();
  if (!device) return 1;
  weft::Scene scene;
  scene.cloths.emplace_back().grid = weft::Grid{.cells_x = 4, .cells_y = 4};
  auto cloth = weft::Simulation::create(**device, scene);
  if (!cloth) return 1;
  if (!(*cloth)->advance(1.0 / 60)) return 1;
  if (!weft::cache_format("cloth.pc2")) return 1;
  return weft::Shading::create(**device, scene, {}, {64, 64}) ? 1 : 0;
}
