// The example that README.md quotes: a flag hung by two corners, simulated for two seconds.
#include <cstdio>

#include "engine/simulation.h"

int main() {
  using namespace weft;
  Scene scene;
  Cloth& flag = scene.cloths.emplace_back();
  flag.grid = Grid{.size = {1.5f, 1}, .cells_x = 48, .cells_y = 32, .upright = true};   // or flag.mesh = "flag.glb"
  flag.anchors.emplace_back().corners = {Corner::low_high, Corner::high_high};

  auto device = compute::Device::create();   // an engine lends its own instead: Device::borrow({... VkDevice, VkQueue ...})
  if (!device) return std::puts(device.error().c_str()), 1;
  auto cloth = Simulation::create(**device, scene);   // everything is allocated and compiled here; a frame only records
  if (!cloth) return std::puts(cloth.error().c_str()), 1;

  for (int frame = 0; frame < 120; ++frame)   // or record(commands, dt) into the engine's command buffer, or submit(dt, waits)
    if (auto done = (*cloth)->advance(1.0 / 60); !done) return std::puts(done.error().c_str()), 1;

  const FrameView positions = (*cloth)->positions();   // bind positions.buffer as a vertex buffer: nothing is copied
  std::printf("%u vertices, %g s simulated on %s\n", positions.count, (*cloth)->time(), (*device)->name().c_str());
}
