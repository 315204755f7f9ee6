// Where each cloth is, found on the GPU and read by the CPU when the tick is done: two or three ticks late, which the box's margin covers.
#pragma once

#include "samples/godot/gpu.h"

namespace weft_godot {

class Bounds {
 public:
  static weft::Result<std::unique_ptr<Bounds>> create(const weft::Simulation& simulation);
  ~Bounds();
  Bounds(const Bounds&) = delete;
  Bounds& operator=(const Bounds&) = delete;

  /// Into the commands of a place, behind a frame of the simulation.
  void record(VkCommandBuffer commands, std::size_t place);
  /// The boxes of a place whose commands are done, two corners a cloth.
  void read(std::size_t place, std::vector<godot::Box>& boxes) const;

 private:
  explicit Bounds(const weft::Simulation& simulation) : simulation_(&simulation), device_(&simulation.device()) {}
  weft::Result<void> make_pipeline();
  weft::Result<void> make_sets();

  const weft::Simulation* simulation_;
  const weft::compute::Device* device_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  std::array<VkDescriptorSet, Commands::kUnderWay> sets_{};
  std::array<ReadBuffer, Commands::kUnderWay> boxes_;
};

}  // namespace weft_godot
