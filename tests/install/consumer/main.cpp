// Links what draws, too.
#include "engine/shading/shading.h"
#include "engine/simulation.h"

int main() {
  auto device = weft::compute::Device::create();
  if (!device) return 1;
  weft::Scene scene;
  scene.cloths.emplace_back().grid = weft::Grid{.cells_x = 4, .cells_y = 4};
  auto cloth = weft::Simulation::create(**device, scene);
  if (!cloth) return 1;
  return &weft::Shading::create == nullptr || !(*cloth)->advance(1.0 / 60);
}
