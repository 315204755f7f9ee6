// Draws a simulation's frames; without having been created it draws nothing.
#pragma once

#include <filesystem>
#include <memory>

#include "engine/shading/shading.h"
#include "engine/simulation.h"
#include "samples/weft/commands.h"

namespace weft::command {

class Painter {
 public:
  /// Complains itself: an appearance that cannot be read is bad input, the rest is the machine.
  Exit create(compute::Device& device, const Simulation& simulation, VkExtent2D size);

  Result<Image> draw(const Simulation& simulation);
  /// Into a PNG; nothing without create.
  Result<void> draw(const Simulation& simulation, const std::filesystem::path& file);

 private:
  std::unique_ptr<Shading> shading_;
  std::uint32_t splits_ = 0;   // that its triangles know of
};

}  // namespace weft::command
