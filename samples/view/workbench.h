// Plain pictures of a simulation, for looking at it while it runs: lit simply or in colours that tell something, with lines over it.
//
// Everything is drawn from the simulation's buffers. Only what lines show that the GPU does not hold comes from the CPU.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <vector>

#include "compute/raster.h"
#include "engine/shading/shading.h"
#include "engine/shading/textures.h"
#include "engine/simulation.h"
#include "samples/view/view.h"
#include "shaders/shading/frame.h"

namespace weft::view {

/// What is shown.
struct Look {
  uint colouring = VIEW_LIT;
  float strain = 0.1f;          // relative: where the colours of strain end
  bool wires = false, spikes = false, anchors = false, colliders = true;
};

/// Lines of one colour, from the CPU.
struct Segments {
  Vec3 colour;                  // sRGB
  std::vector<Vec3> ends;       // m, two a line
};

class Workbench {
 public:
  /// Loads the scene's textures; those that cannot be read are left out, with a sentence each in notes(). `device` must outlive it.
  static Result<std::unique_ptr<Workbench>> create(const compute::Device& device, const Simulation& simulation);

  /// Draws the triangles as they are now, where cloth has torn. Nothing of it may be under way.
  Result<void> follow();
  /// Records a picture of `size`, left in image() for copies and blits. The last one must be done.
  Result<void> record(VkCommandBuffer commands, VkExtent2D size, const Camera& camera, const Look& look, std::span<const Segments> lines);
  VkImage image() const { return picture_.handle(); }
  const std::vector<std::string>& notes() const { return notes_; }
  /// Of all that is drawn.
  std::uint32_t triangles() const { return triangles_; }

 private:
  struct Part {   // what looks alike
    std::uint32_t first_triangle = 0, triangles = 0;   // none: it is not drawn itself
    Vec3 colour;
    Vec2 repeat{1, 1};
    bool is_cloth = true;
    compute::DrawSet maps;
  };

  explicit Workbench(const compute::Device& device, const Simulation& simulation)
      : device_(&device), simulation_(&simulation), textures_(device) {}
  /// What there is of each triangle and vertex besides what moves.
  struct Lists {
    std::vector<std::uint32_t> corners;
    std::vector<Vec4> rests;   // m: lengths of sides
    std::vector<Vec2> uvs;
    double sides = 0;          // m, the sum of the means
    std::size_t meshes = 0;
  };
  Lists lists() const;
  Result<void> create_geometry();
  Result<void> create_parts();
  Result<void> create_pipelines();
  Result<void> create_targets(VkExtent2D size);
  Result<void> create_segments(std::size_t ends);
  Result<void> create_set();
  Result<compute::DrawSet> maps_of(const shading::Look& look);
  void record_surfaces(VkCommandBuffer commands, const Look& look) const;
  void record_solids(VkCommandBuffer commands, const Camera& camera) const;
  void record_lines(VkCommandBuffer commands, const Look& look, std::span<const Segments> lines) const;
  void draw(VkCommandBuffer commands, const compute::OwnedPipeline& pipeline, const Lines& lines, std::uint32_t first,
            std::uint32_t count) const;

  const compute::Device* device_;
  const Simulation* simulation_;
  VkSampleCountFlagBits samples_ = VK_SAMPLE_COUNT_1_BIT;
  std::uint32_t triangles_ = 0, marks_ = 0, vertices_ = 0;
  float tile_ = 1, edge_ = 0.01f;   // m: of the floor's grid; a mean edge
  shading::Frame frame_{};
  compute::Arena geometry_, upload_, segments_;
  std::size_t room_ = 0;            // ends of lines
  compute::OwnedSampler sampler_;
  compute::DescriptorLayout layout_, maps_layout_;
  compute::DrawSet set_;
  shading::Textures textures_;
  std::vector<Part> parts_;
  std::vector<std::string> notes_;
  compute::OwnedPipelineLayout surface_layout_, solid_layout_, lines_layout_, backdrop_layout_;
  compute::OwnedPipeline surface_pipeline_, solid_pipeline_, lines_pipeline_, marks_pipeline_, backdrop_pipeline_;
  compute::DeviceImage picture_, colour_, depth_;
};

}  // namespace weft::view
