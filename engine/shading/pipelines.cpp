#include "engine/shading/pipelines.h"

#include <array>

#include "engine/shading/targets.h"
#include "shaders/embedded.h"

namespace weft::shading {
namespace {

// Positions and normals are the simulation's own, 16 bytes a vertex; texture coordinates are ours.
constexpr std::array<VkVertexInputBindingDescription, 3> kClothBindings{{
    {0, 16, VK_VERTEX_INPUT_RATE_VERTEX},
    {1, 16, VK_VERTEX_INPUT_RATE_VERTEX},
    {2, 8, VK_VERTEX_INPUT_RATE_VERTEX},
}};
constexpr std::array<VkVertexInputAttributeDescription, 3> kClothAttributes{{
    {0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0},
    {1, 1, VK_FORMAT_R32G32B32_SFLOAT, 0},
    {2, 2, VK_FORMAT_R32G32_SFLOAT, 0},
}};
constexpr std::array<VkVertexInputAttributeDescription, 2> kCutAttributes{kClothAttributes[0], kClothAttributes[2]};

}  // namespace

Result<Pipelines> Pipelines::create(const compute::Device& device, VkDescriptorSetLayout frame_set,
                                    VkDescriptorSetLayout cloth_set, bool cut) {
  constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  Pipelines made;
  const std::array cloth_sets = {frame_set, cloth_set};
  const std::array frame_sets = {frame_set};
  const struct {
    compute::OwnedPipelineLayout* layout;
    const char* name;
    std::span<const VkDescriptorSetLayout> sets;
    std::uint32_t push_bytes;
  } layouts[] = {
      {&made.cloth_layout, "cloth", cloth_sets, sizeof(Cloth)},
      {&made.solid_layout, "solid", frame_sets, sizeof(Solid)},
      {&made.screen_layout, "screen", frame_sets, 0},
  };
  for (const auto& [layout, name, sets, push_bytes] : layouts) {
    auto created = compute::create_pipeline_layout(device, name, sets, push_bytes, kStages);
    if (!created) return created.take_error();
    *layout = std::move(*created);
  }

  const std::span<const std::uint32_t> none;
  const auto cloth_vertex = shader("shading/cloth.vert"), solid_vertex = shader("shading/solid.vert"),
             screen_vertex = shader("shading/screen.vert");

  // Into the shadow map, 1 far; the bias keeps surfaces that lean towards the light out of their own shadow.
  compute::DrawPipelineRequest sun;
  sun.depth = kDepthFormat;
  sun.compare = VK_COMPARE_OP_LESS;
  sun.depth_write = true;
  sun.bias = 1;
  sun.slope_bias = 1.5f;
  // Through the camera, 0 far.
  compute::DrawPipelineRequest depth;
  depth.depth = kDepthFormat;
  depth.compare = VK_COMPARE_OP_GREATER;
  depth.depth_write = true;
  compute::DrawPipelineRequest screen;
  screen.vertex = screen_vertex;
  screen.layout = made.screen_layout.get();
  screen.colour = kOpenFormat;
  compute::DrawPipelineRequest picture = depth;
  picture.colour = kPictureFormat;
  picture.samples = kSamples;

  const auto of_cloth = [&](compute::DrawPipelineRequest request, std::string name, std::span<const std::uint32_t> fragment) {
    request.name = std::move(name);
    request.vertex = cloth_vertex;
    request.fragment = fragment;
    request.layout = made.cloth_layout.get();
    request.bindings = kClothBindings;
    request.attributes = kClothAttributes;
    return request;
  };
  const auto of_cut = [&](const compute::DrawPipelineRequest& request, const char* name) {
    compute::DrawPipelineRequest made_so = of_cloth(request, name, shader("shading/cut.frag"));
    made_so.vertex = shader("shading/cut.vert");
    made_so.attributes = kCutAttributes;
    return made_so;
  };
  const auto of_solid = [&](compute::DrawPipelineRequest request, std::string name, std::span<const std::uint32_t> fragment,
                            VkCullModeFlags cull) {
    request.name = std::move(name);
    request.vertex = solid_vertex;
    request.fragment = fragment;
    request.layout = made.solid_layout.get();
    request.cull = cull;
    return request;
  };
  const auto of_screen = [&](compute::DrawPipelineRequest request, std::string name, std::span<const std::uint32_t> fragment) {
    request.name = std::move(name);
    request.fragment = fragment;
    return request;
  };
  compute::DrawPipelineRequest behind = picture;  // where nothing was drawn
  behind.vertex = screen_vertex;
  behind.layout = made.screen_layout.get();
  behind.compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  behind.depth_write = false;

  const struct {
    compute::OwnedPipeline* pipeline;
    compute::DrawPipelineRequest request;
  } wanted[] = {
      {&made.cloth_sun, of_cloth(sun, "cloth sun", none)},
      {&made.cut_sun, of_cut(sun, "cut cloth sun")},
      {&made.solid_sun, of_solid(sun, "solid sun", none, VK_CULL_MODE_NONE)},
      {&made.cloth_depth, of_cloth(depth, "cloth depth", none)},
      {&made.cut_depth, of_cut(depth, "cut cloth depth")},
      {&made.solid_depth, of_solid(depth, "solid depth", none, VK_CULL_MODE_BACK_BIT)},
      {&made.occlusion, of_screen(screen, "occlusion", shader("shading/occlusion.frag"))},
      {&made.smooth, of_screen(screen, "smooth", shader("shading/smooth.frag"))},
      {&made.cloth, of_cloth(picture, "cloth", shader("shading/cloth.frag"))},
      {&made.solid, of_solid(picture, "solid", shader("shading/solid.frag"), VK_CULL_MODE_BACK_BIT)},
      {&made.sky, of_screen(behind, "sky", shader("shading/sky.frag"))},
  };
  for (const auto& [pipeline, request] : wanted) {
    if (!cut && (pipeline == &made.cut_sun || pipeline == &made.cut_depth)) continue;
    auto created = compute::create_draw_pipeline(device, request);
    if (!created) return created.take_error();
    *pipeline = std::move(*created);
  }
  return made;
}

}  // namespace weft::shading
