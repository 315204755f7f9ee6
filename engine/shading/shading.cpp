#include "engine/shading/shading.h"

#include <array>
#include <cmath>
#include <cstring>

#include "engine/shading/sky.h"
#include "engine/shading/state.h"

namespace weft {
namespace {

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

// One vertex view of a frame must be what the pipelines were made for.
Result<void> check(const FrameView& view, const char* name, std::size_t vertices) {
  if (view.buffer == VK_NULL_HANDLE) return fail("the frame's ", name, " have no buffer");
  if (view.format != VK_FORMAT_R32G32B32A32_SFLOAT || view.stride != 16)
    return fail("the frame's ", name, " have format ", static_cast<int>(view.format), " and a stride of ", view.stride,
                " bytes; drawn are RGBA32F (", static_cast<int>(VK_FORMAT_R32G32B32A32_SFLOAT), ") with a stride of 16");
  if (view.count < vertices) return fail("the frame has ", view.count, " ", name, ", but the cloths have ", vertices, " vertices");
  return {};
}

Vec3 floor_colour(const Scene& scene) {
  for (const Collider& collider : scene.colliders)
    if (collider.shape == ColliderShape::plane && collider.normal.y > 0.7f) return collider.colour;
  return {0.3f, 0.3f, 0.3f};
}

// The i-th of what is drawn: a cloth, or a mesh collider after all cloths. Colliders look as the other shapes do (layout.cpp).
struct Drawn {
  std::string name;
  Appearance look;
  double transmission = 0;
};

Result<Drawn> drawn_of(const Scene& scene, std::size_t i, const ShadedCloth& shaded) {
  if (shaded.appearance != nullptr) {
    const std::string name = i < scene.cloths.size() ? scene.cloths[i].name : std::to_string(i);
    return Drawn{"cloth \"" + name + "\"", *shaded.appearance, shaded.transmission};
  }
  const std::vector<std::uint32_t> meshes = mesh_colliders(scene);
  const std::size_t k = i - scene.cloths.size();   // a cloth wraps around and is beyond them
  if (k >= meshes.size()) return fail("cloth ", i, " has no appearance, and is no mesh collider of the scene");
  Drawn drawn{"collider " + std::to_string(meshes[k]), {}, 0};
  drawn.look.base_colour = scene.colliders[meshes[k]].colour;
  drawn.look.roughness_factor = 0.45;
  return drawn;
}

}  // namespace

std::vector<ShadedCloth> shaded_cloths(const Scene& scene, const CookedFabric& fabric, std::span<const Mesh> meshes) {
  std::vector<ShadedCloth> cloths;
  for (const Cloth& cloth : scene.cloths)
    cloths.push_back({.mesh = &meshes[cloths.size()].render, .appearance = &cloth.appearance, .shown = cloth.render_mesh.empty()});
  for (std::size_t k = 0; k < mesh_colliders(scene).size(); ++k) cloths.push_back({.mesh = &meshes[cloths.size()].render});
  for (const CarriedMesh& carried : fabric.render_meshes)
    cloths.push_back({.mesh = &meshes[cloths.size()].render, .appearance = &scene.cloths[carried.cloth].appearance});
  return cloths;
}

Shading::State::~State() {
  try {
    (void)wait();
  } catch (const std::bad_alloc&) {   // it failed, and there is no memory to say so
  }
}

Shading::Shading() = default;
Shading::~Shading() = default;

Result<void> Shading::State::create_frame() {
  const compute::BufferRequest block{"shading frame", sizeof(shading::Frame), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT};
  auto uploaded = compute::Arena::create(*device, compute::Memory::upload, "shading frame", {&block, 1});
  if (!uploaded) return uploaded.take_error();
  upload = std::move(*uploaded);

  auto set = shading::FrameSet::create(*device);
  if (!set) return set.take_error();
  frame_set = std::move(*set);

  auto commands_from = compute::CommandPool::create(*device, "shading");
  if (!commands_from) return commands_from.take_error();
  pool = std::move(*commands_from);
  auto buffer = pool.allocate("shading");
  if (!buffer) return buffer.take_error();
  own_commands = *buffer;
  auto signal = compute::create_fence(*device, "shading");
  if (!signal) return signal.take_error();
  fence = std::move(*signal);
  return {};
}

Result<void> Shading::Geometry::add(const std::string& name, const RenderMesh& mesh) {
  for (const Triangle& triangle : mesh.triangles)
    for (std::uint32_t vertex : triangle)
      if (vertex >= mesh.positions.size())
        return fail("a triangle of ", name, " refers to vertex ", vertex, ", but there are ", mesh.positions.size());
  const std::size_t first = uvs.size();
  uvs.insert(uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
  uvs.resize(first + mesh.positions.size());  // a mesh without texture coordinates has zeros
  triangles.insert(triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
  return {};
}

Result<void> Shading::State::create_cloths(const Scene& scene, std::span<const ShadedCloth> shaded) {
  auto sampler = compute::create_sampler(*device, "map sampler", {.linear = true, .repeat = true});
  if (!sampler) return sampler.take_error();
  map_sampler = std::move(*sampler);
  constexpr VkDescriptorType kMap = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  const std::array bindings = {compute::DescriptorBinding{0, kMap}, compute::DescriptorBinding{1, kMap},
                               compute::DescriptorBinding{2, kMap}, compute::DescriptorBinding{3, kMap}};
  auto layout = compute::DescriptorLayout::create(*device, "cloth maps", bindings, VK_SHADER_STAGE_FRAGMENT_BIT);
  if (!layout) return layout.take_error();
  map_layout = std::move(*layout);

  Geometry all;
  for (std::size_t i = 0; i < shaded.size(); ++i) {
    const RenderMesh& mesh = *shaded[i].mesh;
    auto described = drawn_of(scene, i, shaded[i]);
    if (!described) return described.take_error();
    const auto& [name, look, transmission] = *described;
    if (mesh.triangles.empty()) return fail(name, " has no triangle to draw");

    DrawnCloth drawn;
    drawn.first_vertex = static_cast<std::uint32_t>(all.uvs.size());
    drawn.first_index = static_cast<std::uint32_t>(3 * all.triangles.size());
    drawn.index_count = shaded[i].shown ? static_cast<std::uint32_t>(3 * mesh.triangles.size()) : 0;
    drawn.push = {look.base_colour, static_cast<float>(look.roughness_factor), look.repeat, static_cast<float>(look.metallic),
                  static_cast<float>(transmission), WEFT_VIEW_CAMERA};
    if (auto added = all.add(name, mesh); !added) return added;

    const struct {
      const std::string& file;
      shading::Content content;
      std::array<std::uint8_t, 4> fallback;
    } maps[] = {
        {look.albedo, shading::Content::colour, {255, 255, 255, 255}},
        {look.normal, shading::Content::data, {128, 128, 255, 255}},
        {look.roughness, shading::Content::data, {255, 255, 255, 255}},
        {look.occlusion, shading::Content::data, {255, 255, 255, 255}},
    };
    std::vector<compute::DrawBinding> bound;
    for (const auto& [file, content, fallback] : maps) {
      auto texture = textures.load(file.empty() ? std::filesystem::path() : scene.folder / file, content, fallback);
      if (!texture) return fail(name, ": ", texture.why());
      const VkDescriptorImageInfo image{map_sampler.get(), (*texture)->view(), compute::kSampled.layout};
      bound.push_back({static_cast<std::uint32_t>(bound.size()), {}, image});
    }
    auto set = compute::DrawSet::create(*device, "maps of " + name, map_layout, bound);
    if (!set) return set.take_error();
    drawn.maps = std::move(*set);
    cloths.push_back(std::move(drawn));
  }

  vertices = all.uvs.size();
  triangles = all.triangles.size();
  const std::array requests = {
      compute::BufferRequest{"shading uvs", all.uvs.size() * sizeof(Vec2),
                             VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT},
      compute::BufferRequest{"shading indices", all.triangles.size() * sizeof(Triangle),
                             VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT},
  };
  auto arena = compute::Arena::create(*device, compute::Memory::device, "shading geometry", requests);
  if (!arena) return arena.take_error();
  geometry = std::move(*arena);
  if (cloths.empty()) return {};
  return send(all);
}

Result<void> Shading::State::send(const Geometry& all) {
  const std::array uploads = {compute::Upload{&geometry[0], bytes_of(all.uvs)}, compute::Upload{&geometry[1], bytes_of(all.triangles)}};
  return compute::upload_all(*device, uploads);
}

Result<void> Shading::follow(std::span<const ShadedCloth> cloths) try {
  Geometry all;
  if (cloths.size() != state_->cloths.size()) return fail(cloths.size(), " cloths were given for ", state_->cloths.size());
  for (const ShadedCloth& cloth : cloths)
    if (auto added = all.add("cloth " + std::to_string(&cloth - cloths.data()), *cloth.mesh); !added) return added;
  if (all.uvs.size() != state_->vertices || all.triangles.size() != state_->triangles)
    return fail(all.uvs.size(), " vertices and ", all.triangles.size(), " triangles were given for ", state_->vertices, " and ",
                state_->triangles);
  return state_->send(all);
} catch (...) {
  return caught("the torn cloth's picture");
}

Result<std::unique_ptr<Shading>> Shading::create(compute::Device& device, const Scene& scene, std::span<const ShadedCloth> cloths,
                                                 VkExtent2D size) try {
  if (!device.draws())
    return fail("device \"", device.name(), "\" cannot draw: pictures take Vulkan 1.3, a queue with graphics, and the features ",
                "synchronization2 and dynamicRendering enabled");
  if (length(scene.light.direction) == 0) return fail("the light's direction has no length");

  std::unique_ptr<Shading> made(new Shading);
  made->state_ = std::make_unique<State>(device);
  State& state = *made->state_;
  state.camera = scene.camera;
  state.colliders = scene.colliders;
  state.solids.reserve(scene.colliders.size());

  std::vector<std::span<const Vec3>> places;
  for (const ShadedCloth& cloth : cloths) places.emplace_back(cloth.mesh->positions);
  if (places.empty() && scene.colliders.empty()) return fail("there is neither a cloth nor a collider to draw");
  const shading::Extent extent = shading::extent_of(scene, places);
  state.tile = shading::tile_size(extent.radius);
  shading::set_sky(state.frame, scene.light, floor_colour(scene));
  shading::set_sun(state.frame, extent, shading::kSunTexels);
  state.frame.occlusion_radius = 0.15f * extent.radius;
  state.frame.fade = 6 * (extent.radius + length(scene.camera.target - scene.camera.eye));

  if (auto ready = state.create_frame(); !ready) return ready.take_error();
  if (auto ready = state.resize(size); !ready) return ready.take_error();
  if (auto ready = state.create_cloths(scene, cloths); !ready) return ready.take_error();
  auto pipelines = shading::Pipelines::create(device, state.frame_set.layout.handle(), state.map_layout.handle());
  if (!pipelines) return pipelines.take_error();
  state.pipelines = std::move(*pipelines);
  return made;
} catch (...) {
  return caught("the picture");
}

void Shading::look_from(const Camera& camera) {
  state_->camera = camera;
  shading::set_camera(state_->frame, camera, state_->size.width, state_->size.height);
}

Result<void> Shading::State::resize(VkExtent2D to) {
  constexpr std::uint32_t kLargest = 8192;
  if (to.width < 1 || to.height < 1 || to.width > kLargest || to.height > kLargest)
    return fail("a picture of ", to.width, " x ", to.height, " pixels is outside 1 x 1 ... ", kLargest, " x ", kLargest);
  if (auto done = wait(); !done) return done;
  const VkDeviceSize picture_bytes = VkDeviceSize{4} * to.width * to.height;
  const compute::BufferRequest pixels{"shading picture", picture_bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  auto read = compute::Arena::create(*device, compute::Memory::readback, "shading picture", {&pixels, 1});
  if (!read) return read.take_error();
  auto made = shading::Targets::create(*device, to);
  if (!made) return made.take_error();
  auto set = frame_set.of(*device, *made, upload[0]);
  if (!set) return set.take_error();
  frame_set.set = std::move(*set);   // before the targets that the old one names
  targets = std::move(*made);
  readback = std::move(*read);
  size = to;
  shading::set_camera(frame, camera, size.width, size.height);
  return {};
}

// A draw that failed while waiting may still be on the GPU.
Result<void> Shading::State::wait() {
  if (!in_flight) return {};
  if (auto done = compute::wait_for(*device, fence.get()); !done) return done;
  in_flight = false;
  return {};
}

Result<void> Shading::State::prepare(const Poses& poses) {
  if (vertices > 0) {
    if (auto good = check(poses.positions, "positions", vertices); !good) return good.take_error();
    if (auto good = check(poses.normals, "normals", vertices); !good) return good.take_error();
  }
  if (poses.colliders.size() != colliders.size())
    return fail("the frame has ", poses.colliders.size(), " collider poses, but the scene has ", colliders.size(), " colliders");
  if (!poses.sizes.empty() && poses.sizes.size() != colliders.size())
    return fail("the frame has ", poses.sizes.size(), " sizes of colliders, but the scene has ", colliders.size(), " colliders");
  if (auto done = wait(); !done) return done;

  std::memcpy(upload[0].mapped, &frame, sizeof(frame));
  solids.clear();
  for (std::size_t i = 0; i < colliders.size(); ++i)
    if (colliders[i].shape != ColliderShape::mesh)   // those are among the cloths
      solids.push_back(shading::solid_of(colliders[i], poses.colliders[i], poses.sizes.empty() ? size_of(colliders[i]) : poses.sizes[i],
                                         frame, camera.target, tile));
  return {};
}

Result<void> Shading::record(VkCommandBuffer commands, const Poses& poses) try {
  if (commands == VK_NULL_HANDLE) return fail("the command buffer to record the picture into is null");
  if (auto ready = state_->prepare(poses); !ready) return ready;
  state_->record_picture(commands, poses);
  return {};
} catch (...) {
  return caught("the picture");
}

Result<void> Shading::resize(VkExtent2D size) try {
  return state_->resize(size);
} catch (...) {
  return caught("the picture");
}

VkImage Shading::image() const { return state_->targets.picture.handle(); }

Result<Image> Shading::draw(const Poses& poses) try {
  State& state = *state_;
  if (auto ready = state.prepare(poses); !ready) return ready.take_error();
  if (auto recorded = state.record_copy(poses); !recorded) return recorded.take_error();

  const VkFence fence = state.fence.get();
  if (VkResult r = state.device->vk().vkResetFences(state.device->handle(), 1, &fence))
    return fail("the shading fence could not be reset: ", compute::result_name(r));
  auto commands = compute::typed<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
  commands.commandBuffer = state.own_commands;
  auto wait = compute::typed<VkSemaphoreSubmitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO);
  wait.semaphore = poses.ready;
  wait.value = poses.ready_value;
  wait.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  auto submit = compute::typed<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
  submit.waitSemaphoreInfoCount = poses.ready == VK_NULL_HANDLE ? 0 : 1;
  submit.pWaitSemaphoreInfos = &wait;
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &commands;
  if (auto sent = state.device->submit(submit, fence); !sent) return sent.take_error();
  state.in_flight = true;
  if (auto done = compute::wait_for(*state.device, fence); !done) return done.take_error();
  state.in_flight = false;

  Image image{state.size.width, state.size.height, {}};
  const auto* pixels = reinterpret_cast<const std::uint8_t*>(state.readback[0].mapped);
  image.rgba.assign(pixels, pixels + std::size_t{4} * image.width * image.height);
  return image;
} catch (...) {
  return caught("the picture");
}

}  // namespace weft
