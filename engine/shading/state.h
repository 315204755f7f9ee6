// What a Shading holds: made in create, or in resize what has the picture's size; only recorded from in draw.
#pragma once

#include <string>
#include <vector>

#include "compute/buffer.h"
#include "compute/commands.h"
#include "engine/shading/layout.h"
#include "engine/shading/looks.h"
#include "engine/shading/pipelines.h"
#include "engine/shading/shading.h"
#include "engine/shading/targets.h"
#include "engine/shading/textures.h"

namespace weft {

/// What the vertex and index buffers hold besides what moves.
struct Shading::Geometry {
  std::vector<Vec2> uvs;
  std::vector<Triangle> triangles;
  /// Triangles that follow each other and look alike.
  struct Run {
    std::uint32_t material = kNone, first_vertex = 0, first_triangle = 0, triangles = 0;
    bool operator==(const Run&) const = default;
  };
  std::vector<Run> runs;
  /// In one run, or one for each material. Errors: an index or a material out of range.
  Result<void> add(const std::string& name, const ShadedCloth& cloth);
};

struct Shading::State {
  explicit State(compute::Device& on) : device(&on), textures(on) {}
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// One run's share of the vertex and index buffers, and its four maps.
  struct DrawnCloth {
    std::uint32_t first_vertex = 0, first_index = 0, index_count = 0;
    shading::Cloth push;
    compute::DrawSet maps;
  };

  compute::Device* device;
  VkExtent2D size{};
  Camera camera;
  std::vector<Collider> colliders;
  shading::Frame frame{};
  float tile = 1;
  std::size_t meshes = 0, vertices = 0, triangles = 0;
  std::vector<Geometry::Run> runs;
  std::vector<std::string> notes;

  compute::Arena upload;    // the frame block
  compute::Arena readback;  // the picture
  compute::Arena geometry;  // texture coordinates, indices
  shading::Targets targets;
  shading::FrameSet frame_set;
  compute::OwnedSampler map_sampler;
  compute::DescriptorLayout map_layout;
  shading::Textures textures;
  shading::Pipelines pipelines;
  std::vector<DrawnCloth> cloths;
  std::vector<shading::Solid> solids;  // of the frame that is being drawn
  compute::CommandPool pool;
  VkCommandBuffer own_commands = VK_NULL_HANDLE;
  compute::OwnedFence fence;
  bool in_flight = false;

  Result<void> create_frame();
  /// What has the picture's size, and the camera that sees all of it: made first, then put in place of what there was.
  Result<void> resize(VkExtent2D to);
  Result<void> create_cloths(const Scene& scene, std::span<const ShadedCloth> shaded);
  Result<compute::DrawSet> maps_of(shading::Look& look);
  Result<void> send(const Geometry& all);

  Result<void> wait();

  /// Checks the poses, waits for the picture before, and takes over what is of this frame.
  Result<void> prepare(const Poses& poses);
  void record_picture(VkCommandBuffer commands, const Poses& poses);
  Result<void> record_copy(const Poses& poses);   // all of draw's commands
  /// `cut` is for what has holes in its texture.
  void record_cloths(VkCommandBuffer commands, const Poses& poses, const compute::OwnedPipeline& whole, const compute::OwnedPipeline& cut,
                     std::uint32_t view);
  void record_solids(VkCommandBuffer commands, VkPipeline pipeline, std::uint32_t view);
  void record_screen(VkCommandBuffer commands, const compute::DeviceImage& target, VkPipeline pipeline);
};

}  // namespace weft
