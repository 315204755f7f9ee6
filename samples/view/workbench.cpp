// See samples/view/workbench.h.
#include "samples/view/workbench.h"

#include <vulkan/vulkan.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "backdrop.frag.h"
#include "engine/shading/layout.h"
#include "engine/shading/sky.h"
#include "lines.frag.h"
#include "lines.vert.h"
#include "shaders/embedded.h"
#include "solid.frag.h"
#include "surface.frag.h"
#include "surface.vert.h"

namespace weft::view {
namespace {

// The shaders write sRGB values themselves, and blits must not convert them.
constexpr VkFormat kPicture = VK_FORMAT_R8G8B8A8_UNORM, kDepth = VK_FORMAT_D32_SFLOAT;
constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
constexpr compute::ImageUse kLeft{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                  VK_ACCESS_2_TRANSFER_READ_BIT};

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

template <class T>
Result<void> take(Result<T> made, T& into) {
  if (!made) return made.take_error();
  into = std::move(*made);
  return {};
}

}  // namespace

Result<std::unique_ptr<Workbench>> Workbench::create(const compute::Device& device, const Simulation& simulation) {
  std::unique_ptr<Workbench> made(new Workbench(device, simulation));
  made->samples_ = device.is_software() ? VK_SAMPLE_COUNT_1_BIT : VK_SAMPLE_COUNT_4_BIT;
  if (auto done = made->create_geometry(); !done) return done.take_error();
  if (auto done = made->create_parts(); !done) return done.take_error();
  if (auto done = made->create_pipelines(); !done) return done.take_error();
  return made;
}

Workbench::Lists Workbench::lists() const {
  Lists lists;
  const std::size_t cloths = simulation_->fabric().cloths.size();
  for (const ShadedCloth& shaded : shaded_cloths(simulation_->scene(), simulation_->fabric(), simulation_->meshes())) {
    const RenderMesh& mesh = *shaded.mesh;
    const bool is_simulated = lists.meshes++ < cloths;
    const auto first = static_cast<std::uint32_t>(lists.uvs.size());
    for (const auto& [material, triangles] : shading::runs_of(mesh, shaded.appearance))
      for (const Triangle& t : triangles) {
        const auto& at = mesh.positions;
        const Vec3 sides{length(at[t[1]] - at[t[0]]), length(at[t[2]] - at[t[1]]), length(at[t[0]] - at[t[2]])};
        lists.sides += (sides.x + sides.y + sides.z) / 3;
        for (const std::uint32_t vertex : t) lists.corners.push_back(first + vertex);
        lists.rests.push_back(is_simulated ? Vec4{sides.x, sides.y, sides.z, 0} : Vec4{});
      }
    lists.uvs.insert(lists.uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
    lists.uvs.resize(first + mesh.positions.size());
  }
  return lists;
}

Result<void> Workbench::follow() {
  const Lists now = lists();
  const std::array uploads = {compute::Upload{&geometry_[0], bytes_of(now.corners)}, compute::Upload{&geometry_[1], bytes_of(now.rests)},
                              compute::Upload{&geometry_[2], bytes_of(now.uvs)}};
  return compute::upload_all(*device_, uploads);
}

Result<void> Workbench::create_geometry() {
  const Scene& scene = simulation_->scene();
  const Lists all = lists();
  const auto& [corners, rests, uvs, sides, meshes] = all;
  std::vector<std::span<const Vec3>> places;
  for (const Mesh& mesh : simulation_->meshes()) places.emplace_back(mesh.render.positions);
  vertices_ = static_cast<std::uint32_t>(uvs.size());
  triangles_ = static_cast<std::uint32_t>(rests.size());
  edge_ = static_cast<float>(sides / std::max<double>(static_cast<double>(rests.size()), 1));
  std::vector<std::uint32_t> marked;
  for (const AnchorTarget& anchor : simulation_->fabric().anchors) marked.push_back(anchor.vertex);
  marks_ = static_cast<std::uint32_t>(marked.size());

  const shading::Extent extent = shading::extent_of(scene, places);
  tile_ = shading::tile_size(extent.radius);
  shading::set_sky(frame_, scene.light, {0.3f, 0.3f, 0.3f});
  frame_.fade = 6 * (extent.radius + length(scene.camera.target - scene.camera.eye));
  constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  const std::array requests = {compute::BufferRequest{"view corners", bytes_of(corners).size(), kUsage | VK_BUFFER_USAGE_INDEX_BUFFER_BIT},
                               compute::BufferRequest{"view rests", bytes_of(rests).size(), kUsage},
                               compute::BufferRequest{"view uvs", bytes_of(uvs).size(), kUsage},
                               compute::BufferRequest{"view marks", bytes_of(marked).size(), kUsage}};
  if (auto done = take(compute::Arena::create(*device_, compute::Memory::device, "view", requests), geometry_); !done) return done;
  std::vector<compute::Upload> uploads;
  for (const auto bytes : {bytes_of(corners), bytes_of(rests), bytes_of(uvs), bytes_of(marked)}) {
    const std::size_t place = uploads.size();
    uploads.push_back({&geometry_[place], bytes});
  }
  std::erase_if(uploads, [](const compute::Upload& one) { return one.bytes.empty(); });
  if (auto done = compute::upload_all(*device_, uploads); !done) return done;
  const compute::BufferRequest block{"view frame", sizeof(shading::Frame), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT};
  return take(compute::Arena::create(*device_, compute::Memory::upload, "view frame", {&block, 1}), upload_);
}

Result<compute::DrawSet> Workbench::maps_of(const shading::Look& look) {
  std::vector<compute::DrawBinding> bound;
  for (const shading::Source& source : look.maps) {
    auto loaded = textures_.load(source);
    if (!loaded) {
      if (std::ranges::find(notes_, loaded.error()) == notes_.end()) notes_.push_back(loaded.error());
      loaded = textures_.load({.map = source.map});
    }
    if (!loaded) return loaded.take_error();
    bound.push_back({static_cast<std::uint32_t>(bound.size()), {}, {sampler_.get(), (*loaded)->view(), compute::kSampled.layout}});
  }
  return compute::DrawSet::create(*device_, "view maps", maps_layout_, bound);
}

Result<void> Workbench::create_parts() {
  if (auto done = take(compute::create_sampler(*device_, "view maps", {.linear = true, .repeat = true}), sampler_); !done) return done;
  constexpr VkDescriptorType kMap = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kBuffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  const std::array maps = {compute::DescriptorBinding{0, kMap}, compute::DescriptorBinding{1, kMap}, compute::DescriptorBinding{2, kMap},
                           compute::DescriptorBinding{3, kMap}};
  if (auto done = take(compute::DescriptorLayout::create(*device_, "view maps", maps, VK_SHADER_STAGE_FRAGMENT_BIT), maps_layout_); !done)
    return done;
  std::vector<compute::DescriptorBinding> bindings = {{0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER}};
  for (std::uint32_t k = 1; k <= 7; ++k) bindings.push_back({k, kBuffer});
  if (auto done = take(compute::DescriptorLayout::create(*device_, "view", bindings, kStages), layout_); !done) return done;

  const Scene& scene = simulation_->scene();
  const std::vector<std::uint32_t> bodies = mesh_colliders(scene);
  const std::vector<ShadedCloth> shaded = shaded_cloths(scene, simulation_->fabric(), simulation_->meshes());
  std::uint32_t first = 0;
  for (std::size_t k = 0; k < shaded.size(); ++k) {
    const auto& [mesh, appearance, transmission, shown] = shaded[k];
    Appearance plain;
    if (appearance == nullptr) plain.base_colour = scene.colliders[bodies[k - scene.cloths.size()]].colour;
    const shading::Look own = shading::look_of("view", appearance != nullptr ? *appearance : plain, scene.folder);
    std::vector<shading::Look> looks;
    std::vector<std::string> left;   // the picture says so
    if (mesh->materials) looks = shading::looks_of("view", *mesh->materials, left);
    for (const auto& [material, triangles] : shading::runs_of(*mesh, appearance)) {
      const shading::Look& look = material < looks.size() ? looks[material] : own;
      Part part;
      part.first_triangle = first;
      first += static_cast<std::uint32_t>(triangles.size());
      if (shown) part.triangles = static_cast<std::uint32_t>(triangles.size());
      part.is_cloth = appearance != nullptr;
      part.colour = look.base_colour;
      part.repeat = look.repeat;
      if (auto done = take(maps_of(look), part.maps); !done) return done;
      parts_.push_back(std::move(part));
    }
  }
  return create_segments(0);
}

Result<void> Workbench::create_segments(std::size_t ends) {
  room_ = std::max<std::size_t>(ends, 1024);
  const compute::BufferRequest request{"view lines", room_ * sizeof(Vec4), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
  auto arena = compute::Arena::create(*device_, compute::Memory::upload, "view lines", {&request, 1});
  if (auto done = take(std::move(arena), segments_); !done) return done;
  return create_set();
}

Result<void> Workbench::create_set() {
  const FrameView positions = simulation_->positions(), normals = simulation_->normals();
  const auto whole = [](const compute::Buffer& buffer) { return VkDescriptorBufferInfo{buffer.handle, 0, VK_WHOLE_SIZE}; };
  const auto view = [](const FrameView& of) { return VkDescriptorBufferInfo{of.buffer, of.offset, VkDeviceSize{of.stride} * of.count}; };
  const std::array bound = {compute::DrawBinding{0, whole(upload_[0]), {}},   compute::DrawBinding{1, view(positions), {}},
                            compute::DrawBinding{2, view(normals), {}},       compute::DrawBinding{3, whole(geometry_[0]), {}},
                            compute::DrawBinding{4, whole(geometry_[1]), {}}, compute::DrawBinding{5, whole(geometry_[2]), {}},
                            compute::DrawBinding{6, whole(geometry_[3]), {}}, compute::DrawBinding{7, whole(segments_[0]), {}}};
  return take(compute::DrawSet::create(*device_, "view", layout_, bound), set_);
}

Result<void> Workbench::create_pipelines() {
  const std::array both = {layout_.handle(), maps_layout_.handle()};
  const std::array one = {layout_.handle()};
  const struct {
    compute::OwnedPipelineLayout* layout;
    const char* name;
    std::span<const VkDescriptorSetLayout> sets;
    std::uint32_t bytes;
  } layouts[] = {{&surface_layout_, "view surface", both, sizeof(Surface)},
                 {&solid_layout_, "view solid", one, sizeof(shading::Solid)},
                 {&lines_layout_, "view lines", one, sizeof(Lines)},
                 {&backdrop_layout_, "view backdrop", {}, sizeof(Vec2)}};
  for (const auto& [layout, name, sets, bytes] : layouts)
    if (auto done = take(compute::create_pipeline_layout(*device_, name, sets, bytes, kStages), *layout); !done) return done;

  const auto solid_vertex = shader("shading/solid.vert"), screen_vertex = shader("shading/screen.vert");
  const struct {
    compute::OwnedPipeline* pipeline;
    const char* name;
    std::span<const std::uint32_t> vertex, fragment;
    VkPipelineLayout layout;
    VkCompareOp compare;
    VkCullModeFlags cull;
  } pipelines[] = {
      {&surface_pipeline_, "view surface", view_surface_vert, view_surface_frag, surface_layout_.get(), VK_COMPARE_OP_GREATER, 0},
      {&solid_pipeline_, "view solid", solid_vertex, view_solid_frag, solid_layout_.get(), VK_COMPARE_OP_GREATER, VK_CULL_MODE_BACK_BIT},
      {&lines_pipeline_, "view lines", view_lines_vert, view_lines_frag, lines_layout_.get(), VK_COMPARE_OP_GREATER_OR_EQUAL, 0},
      {&marks_pipeline_, "view marks", view_lines_vert, view_lines_frag, lines_layout_.get(), VK_COMPARE_OP_ALWAYS, 0},
      {&backdrop_pipeline_, "view backdrop", screen_vertex, view_backdrop_frag, backdrop_layout_.get(), VK_COMPARE_OP_ALWAYS, 0}};
  for (const auto& [pipeline, name, vertex, fragment, layout, compare, cull] : pipelines) {
    compute::DrawPipelineRequest request;
    request.name = name;
    request.vertex = vertex;
    request.fragment = fragment;
    request.layout = layout;
    request.colour = kPicture;
    request.depth = kDepth;
    request.samples = samples_;
    request.compare = compare;
    request.cull = cull;
    request.depth_write = compare != VK_COMPARE_OP_ALWAYS;
    if (auto done = take(compute::create_draw_pipeline(*device_, request), *pipeline); !done) return done;
  }
  return {};
}

Result<void> Workbench::create_targets(VkExtent2D size) {
  const VkExtent2D had = picture_.request().size;
  if (picture_.handle() != VK_NULL_HANDLE && had.width == size.width && had.height == size.height) return {};
  constexpr VkImageUsageFlags kColour = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  const compute::ImageRequest picture{"view picture", kPicture, size, kColour | VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
  if (auto done = take(compute::DeviceImage::create(*device_, picture), picture_); !done) return done;
  const compute::ImageRequest depth{"view depth", kDepth, size, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, samples_};
  if (auto done = take(compute::DeviceImage::create(*device_, depth), depth_); !done) return done;
  if (samples_ == VK_SAMPLE_COUNT_1_BIT) return {};
  return take(compute::DeviceImage::create(*device_, {"view samples", kPicture, size, kColour, samples_}), colour_);
}

Result<void> Workbench::record(VkCommandBuffer commands, VkExtent2D size, const Camera& camera, const Look& look,
                               std::span<const Segments> lines) {
  if (auto done = create_targets(size); !done) return done;
  std::vector<Vec4> ends;
  for (const Segments& of : lines)
    for (const Vec3 p : of.ends) ends.push_back({p.x, p.y, p.z, 1});
  if (ends.size() > room_)
    if (auto done = create_segments(2 * ends.size()); !done) return done;
  if (!ends.empty()) std::memcpy(segments_[0].mapped, ends.data(), ends.size() * sizeof(Vec4));
  shading::set_camera(frame_, camera, size.width, size.height);
  std::memcpy(upload_[0].mapped, &frame_, sizeof frame_);

  // What the simulation has written since.
  auto barrier = compute::typed<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_VERTEX_SHADER_BIT, 0, 1, &barrier, 0, nullptr, 0,
                       nullptr);
  const bool resolves = samples_ != VK_SAMPLE_COUNT_1_BIT;
  compute::change_use(*device_, commands, picture_, compute::kUnused, compute::kColourTarget);
  if (resolves) compute::change_use(*device_, commands, colour_, compute::kUnused, compute::kColourTarget);
  compute::change_use(*device_, commands, depth_, compute::kUnused, compute::kDepthTarget);
  compute::begin_drawing(*device_, commands,
                         {.colour = resolves ? &colour_ : &picture_,
                          .resolve = resolves ? &picture_ : nullptr,
                          .depth = &depth_,
                          .clear_depth = 0,
                          .keep_depth = false});
  const compute::Functions& vk = device_->vk();
  const Vec2 pixel{2.0f / static_cast<float>(size.width), 2.0f / static_cast<float>(size.height)};
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, backdrop_pipeline_.get());
  vk.vkCmdPushConstants(commands, backdrop_layout_.get(), kStages, 0, sizeof pixel, &pixel);
  vk.vkCmdDraw(commands, 3, 1, 0, 0);
  record_surfaces(commands, look);
  if (look.colliders) record_solids(commands, camera);
  record_lines(commands, look, lines);
  compute::end_drawing(*device_, commands);
  compute::change_use(*device_, commands, picture_, compute::kColourTarget, kLeft);
  return {};
}

void Workbench::record_surfaces(VkCommandBuffer commands, const Look& look) const {
  const compute::Functions& vk = device_->vk();
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, surface_pipeline_.get());
  vk.vkCmdBindIndexBuffer(commands, geometry_[0].handle, 0, VK_INDEX_TYPE_UINT32);
  for (const Part& part : parts_) {
    if (part.triangles == 0 || (!part.is_cloth && !look.colliders)) continue;
    const VkDescriptorSet sets[] = {set_.handle(), part.maps.handle()};
    vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, surface_layout_.get(), 0, 2, sets, 0, nullptr);
    const uint colouring = part.is_cloth ? look.colouring : VIEW_LIT;
    const bool by_index = !look.wires && colouring != VIEW_STRAIN;
    const Surface push{part.colour, look.strain, part.repeat, part.first_triangle, colouring, look.wires ? 1u : 0u, by_index ? 1u : 0u};
    vk.vkCmdPushConstants(commands, surface_layout_.get(), kStages, 0, sizeof push, &push);
    if (by_index) vk.vkCmdDrawIndexed(commands, 3 * part.triangles, 1, 3 * part.first_triangle, 0, 0);
    else vk.vkCmdDraw(commands, 3 * part.triangles, 1, 0, 0);
  }
}

void Workbench::record_solids(VkCommandBuffer commands, const Camera& camera) const {
  const compute::Functions& vk = device_->vk();
  const VkDescriptorSet set = set_.handle();
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, solid_pipeline_.get());
  vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, solid_layout_.get(), 0, 1, &set, 0, nullptr);
  const std::vector<Collider>& colliders = simulation_->scene().colliders;
  const auto poses = simulation_->colliders();
  const auto sizes = simulation_->collider_sizes();
  for (std::size_t k = 0; k < colliders.size(); ++k) {
    if (colliders[k].shape == ColliderShape::mesh) continue;
    const shading::Solid solid = shading::solid_of(colliders[k], poses[k], sizes[k], frame_, camera.target, tile_);
    vk.vkCmdPushConstants(commands, solid_layout_.get(), kStages, 0, sizeof solid, &solid);
    vk.vkCmdDraw(commands, shading::vertex_count(solid), 1, 0, 0);
  }
}

void Workbench::draw(VkCommandBuffer commands, const compute::OwnedPipeline& pipeline, const Lines& lines, std::uint32_t first,
                     std::uint32_t count) const {
  if (count == 0) return;
  const compute::Functions& vk = device_->vk();
  const VkDescriptorSet set = set_.handle();
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
  vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, lines_layout_.get(), 0, 1, &set, 0, nullptr);
  vk.vkCmdPushConstants(commands, lines_layout_.get(), kStages, 0, sizeof lines, &lines);
  vk.vkCmdDraw(commands, 6 * count, 1, 6 * first, 0);
}

void Workbench::record_lines(VkCommandBuffer commands, const Look& look, std::span<const Segments> lines) const {
  const Vec2 pixel{2 * frame_.size.z, 2 * frame_.size.w};
  const float fine = std::clamp(frame_.size.y / 600, 0.6f, 2.0f);   // a small picture is stretched, and its lines with it
  if (look.spikes) draw(commands, lines_pipeline_, {{0.2f, 0.55f, 1}, edge_, pixel, 1.5f * fine, VIEW_SPIKES}, 0, vertices_);
  std::uint32_t first = 0;
  for (const Segments& of : lines) {
    const auto count = static_cast<std::uint32_t>(of.ends.size() / 2);
    draw(commands, lines_pipeline_, {of.colour, 0, pixel, 2 * fine, VIEW_SEGMENTS}, first, count);
    first += count;
  }
  if (look.anchors) draw(commands, marks_pipeline_, {{1, 0.6f, 0.1f}, 0, pixel, 3 * fine, VIEW_MARKS}, 0, marks_);
}

}  // namespace weft::view
