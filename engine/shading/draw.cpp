// The order of a picture: shadow map, depth, occlusion and its smoothing, then everything with four samples a pixel.
#include <span>

#include "compute/synchronization.h"
#include "engine/shading/state.h"

namespace weft {

using compute::change_use;

namespace {

// What a picture is left for: copies and blits, ours and a host's.
constexpr compute::ImageUse kLeft{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};

}  // namespace

void Shading::State::record_cloths(VkCommandBuffer commands, const Poses& poses, const compute::OwnedPipeline& whole,
                                   const compute::OwnedPipeline& cut, std::uint32_t view) {
  if (cloths.empty()) return;
  const compute::Functions& vk = device->vk();
  const VkPipelineLayout layout = pipelines.cloth_layout.get();
  const VkBuffer buffers[] = {poses.positions.buffer, poses.normals.buffer, geometry[0].handle};
  const VkDeviceSize offsets[] = {poses.positions.offset, poses.normals.offset, 0};
  vk.vkCmdBindVertexBuffers(commands, 0, 3, buffers, offsets);
  vk.vkCmdBindIndexBuffer(commands, geometry[1].handle, 0, VK_INDEX_TYPE_UINT32);
  VkPipeline bound = VK_NULL_HANDLE;
  for (const DrawnCloth& cloth : cloths) {
    const VkPipeline pipeline = cloth.push.cutoff > 0 ? cut.get() : whole.get();
    if (pipeline != bound) vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    bound = pipeline;
    const VkDescriptorSet sets[] = {frame_set.set.handle(), cloth.maps.handle()};
    vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 2, sets, 0, nullptr);
    shading::Cloth push = cloth.push;
    push.view = view;
    vk.vkCmdPushConstants(commands, layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(push), &push);
    vk.vkCmdDrawIndexed(commands, cloth.index_count, 1, cloth.first_index, static_cast<std::int32_t>(cloth.first_vertex), 0);
  }
}

void Shading::State::record_solids(VkCommandBuffer commands, VkPipeline pipeline, std::uint32_t view) {
  const compute::Functions& vk = device->vk();
  const VkPipelineLayout layout = pipelines.solid_layout.get();
  const VkDescriptorSet set = frame_set.set.handle();
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
  vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1, &set, 0, nullptr);
  for (shading::Solid solid : solids) {
    // A plane has no end: as a shadow caster it would darken everything on one side of it.
    if (view == WEFT_VIEW_SUN && solid.shape == WEFT_SHAPE_PLANE) continue;
    solid.view = view;
    vk.vkCmdPushConstants(commands, layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(solid), &solid);
    vk.vkCmdDraw(commands, shading::vertex_count(solid), 1, 0, 0);
  }
}

void Shading::State::record_screen(VkCommandBuffer commands, const compute::DeviceImage& target, VkPipeline pipeline) {
  const compute::Functions& vk = device->vk();
  const VkDescriptorSet set = frame_set.set.handle();
  change_use(*device, commands, target, compute::kUnused, compute::kColourTarget);
  compute::begin_drawing(*device, commands, {.colour = &target});
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
  vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines.screen_layout.get(), 0, 1, &set, 0, nullptr);
  vk.vkCmdDraw(commands, 3, 1, 0, 0);
  compute::end_drawing(*device, commands);
  change_use(*device, commands, target, compute::kColourTarget, compute::kSampled);
}

void Shading::State::record_picture(VkCommandBuffer commands, const Poses& poses) {
  const compute::Functions& vk = device->vk();
  auto barrier = compute::typed<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT;
  compute::record_barrier(*device, commands, barrier);

  change_use(*device, commands, targets.sun_depth, compute::kUnused, compute::kDepthTarget);
  compute::begin_drawing(*device, commands, {.depth = &targets.sun_depth, .clear_depth = 1});
  record_cloths(commands, poses, pipelines.cloth_sun, pipelines.cut_sun, WEFT_VIEW_SUN);
  record_solids(commands, pipelines.solid_sun.get(), WEFT_VIEW_SUN);
  compute::end_drawing(*device, commands);
  change_use(*device, commands, targets.sun_depth, compute::kDepthTarget, compute::kSampled);

  change_use(*device, commands, targets.camera_depth, compute::kUnused, compute::kDepthTarget);
  compute::begin_drawing(*device, commands, {.depth = &targets.camera_depth, .clear_depth = 0});
  record_cloths(commands, poses, pipelines.cloth_depth, pipelines.cut_depth, WEFT_VIEW_CAMERA);
  record_solids(commands, pipelines.solid_depth.get(), WEFT_VIEW_CAMERA);
  compute::end_drawing(*device, commands);
  change_use(*device, commands, targets.camera_depth, compute::kDepthTarget, compute::kSampled);

  record_screen(commands, targets.rough_occlusion, pipelines.occlusion.get());
  record_screen(commands, targets.occlusion, pipelines.smooth.get());

  change_use(*device, commands, targets.samples, compute::kUnused, compute::kColourTarget);
  change_use(*device, commands, targets.picture, compute::kUnused, compute::kColourTarget);
  change_use(*device, commands, targets.sample_depth, compute::kUnused, compute::kDepthTarget);
  compute::begin_drawing(*device, commands,
                         {.colour = &targets.samples,
                          .resolve = &targets.picture,
                          .depth = &targets.sample_depth,
                          .clear_depth = 0,
                          .keep_depth = false});
  record_cloths(commands, poses, pipelines.cloth, pipelines.cloth, WEFT_VIEW_CAMERA);
  record_solids(commands, pipelines.solid.get(), WEFT_VIEW_CAMERA);
  const VkDescriptorSet set = frame_set.set.handle();
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines.sky.get());
  vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines.screen_layout.get(), 0, 1, &set, 0, nullptr);
  vk.vkCmdDraw(commands, 3, 1, 0, 0);
  compute::end_drawing(*device, commands);

  change_use(*device, commands, targets.picture, compute::kColourTarget, kLeft);
}

Result<void> Shading::State::record_copy(const Poses& poses) {
  const compute::Functions& vk = device->vk();
  auto begin = compute::typed<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  if (VkResult r = vk.vkBeginCommandBuffer(own_commands, &begin))
    return fail("the picture's command buffer could not be begun: ", compute::result_name(r));
  record_picture(own_commands, poses);
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {size.width, size.height, 1};
  vk.vkCmdCopyImageToBuffer(own_commands, targets.picture.handle(), kLeft.layout, readback[0].handle, 1, &copy);
  auto barrier = compute::typed<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
  compute::record_barrier(*device, own_commands, barrier);
  if (VkResult r = vk.vkEndCommandBuffer(own_commands))
    return fail("the picture's command buffer could not be recorded: ", compute::result_name(r));
  return {};
}

}  // namespace weft
