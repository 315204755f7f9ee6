#include "engine/shading/shading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/shading/sky.h"
#include "engine/shading/state.h"

namespace weft {
namespace {

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

}  // namespace

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
  auto pipelines = shading::Pipelines::create(device, state.frame_set.layout.handle(), state.map_layout.handle(),
                                              std::ranges::any_of(state.cloths, [](const auto& one) { return one.push.cutoff > 0; }));
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

std::span<const std::string> Shading::notes() const { return state_->notes; }

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
