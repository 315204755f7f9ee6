// See samples/godot/bounds.h.
#include "samples/godot/bounds.h"

#include "bounds.comp.h"   // made by CMake

namespace weft_godot {

using weft::fail;
using weft::Result;

Result<std::unique_ptr<Bounds>> Bounds::create(const weft::Simulation& simulation) {
  std::unique_ptr<Bounds> made(new Bounds(simulation));
  for (ReadBuffer& boxes : made->boxes_) {
    auto buffer = make_read_buffer(*made->device_, 32 * simulation.fabric().cloths.size());
    if (!buffer) return buffer.take_error();
    boxes = *buffer;
  }
  if (auto done = made->make_pipeline(); !done) return done.take_error();
  if (auto done = made->make_sets(); !done) return done.take_error();
  return made;
}

Result<void> Bounds::make_pipeline() {
  const weft::compute::Functions& vk = device_->vk();
  const VkDevice device = device_->handle();
  VkDescriptorSetLayoutBinding bindings[2]{};
  for (std::uint32_t k = 0; k < 2; ++k) bindings[k] = {k, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  const VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, nullptr, 0, 2, bindings};
  if (vk.vkCreateDescriptorSetLayout(device, &set, nullptr, &set_layout_) != VK_SUCCESS)
    return fail(weft::ErrorKind::memory, "a descriptor set layout cannot be made");
  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, 12};
  const VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, nullptr, 0, 1, &set_layout_, 1, &push};
  if (vk.vkCreatePipelineLayout(device, &layout, nullptr, &layout_) != VK_SUCCESS)
    return fail(weft::ErrorKind::memory, "a pipeline layout cannot be made");
  const VkShaderModuleCreateInfo code{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, nullptr, 0, sizeof bounds_comp, bounds_comp};
  VkShaderModule module = VK_NULL_HANDLE;
  if (vk.vkCreateShaderModule(device, &code, nullptr, &module) != VK_SUCCESS)
    return fail(weft::ErrorKind::memory, "a shader module cannot be made");
  VkComputePipelineCreateInfo pipeline{};
  pipeline.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  pipeline.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_COMPUTE_BIT, module, "main", nullptr};
  pipeline.layout = layout_;
  const VkResult made = vk.vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &pipeline, nullptr, &pipeline_);
  vk.vkDestroyShaderModule(device, module, nullptr);
  if (made != VK_SUCCESS) return fail("the pipeline of bounding boxes cannot be made: ", weft::compute::result_name(made));
  return {};
}

Result<void> Bounds::make_sets() {
  const weft::compute::Functions& vk = device_->vk();
  const VkDevice device = device_->handle();
  constexpr std::uint32_t kSets = Commands::kUnderWay;
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2 * kSets};
  const VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, nullptr, 0, kSets, 1, &size};
  if (vk.vkCreateDescriptorPool(device, &pool, nullptr, &pool_) != VK_SUCCESS)
    return fail(weft::ErrorKind::memory, "a descriptor pool cannot be made");
  std::array<VkDescriptorSetLayout, kSets> layouts;
  layouts.fill(set_layout_);
  const VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, nullptr, pool_, kSets, layouts.data()};
  if (vk.vkAllocateDescriptorSets(device, &allocate, sets_.data()) != VK_SUCCESS)
    return fail(weft::ErrorKind::memory, "descriptor sets cannot be made");
  const weft::FrameView positions = simulation_->positions();
  for (std::size_t k = 0; k < kSets; ++k) {
    const VkDescriptorBufferInfo buffers[2] = {{positions.buffer, positions.offset, VkDeviceSize(positions.count) * positions.stride},
                                               {boxes_[k].buffer, 0, VK_WHOLE_SIZE}};
    const VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, nullptr, sets_[k], 0,      0, 2,
                                     VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,      nullptr, buffers,  nullptr};
    vk.vkUpdateDescriptorSets(device, 1, &write, 0, nullptr);
  }
  return {};
}

Bounds::~Bounds() {
  const weft::compute::Functions& vk = device_->vk();
  vk.vkDestroyDescriptorPool(device_->handle(), pool_, nullptr);
  vk.vkDestroyPipeline(device_->handle(), pipeline_, nullptr);
  vk.vkDestroyPipelineLayout(device_->handle(), layout_, nullptr);
  vk.vkDestroyDescriptorSetLayout(device_->handle(), set_layout_, nullptr);
  for (const ReadBuffer& boxes : boxes_) destroy(*device_, boxes);
}

void Bounds::record(VkCommandBuffer commands, std::size_t place) {
  const weft::compute::Functions& vk = device_->vk();
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
  vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &sets_[place], 0, nullptr);
  std::uint32_t cloth = 0;
  for (const weft::ClothRange& range : simulation_->fabric().cloths) {
    const std::uint32_t push[3] = {range.first_vertex, range.vertices, cloth++};
    vk.vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, push);
    vk.vkCmdDispatch(commands, 1, 1, 1);
  }
  const VkMemoryBarrier to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, VK_ACCESS_SHADER_WRITE_BIT, VK_ACCESS_HOST_READ_BIT};
  vk.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0, nullptr, 0,
                          nullptr);
}

void Bounds::read(std::size_t place, std::vector<godot::Box>& boxes) const {
  boxes.resize(simulation_->fabric().cloths.size());
  const float* at = boxes_[place].floats;
  for (godot::Box& box : boxes) {
    const weft::Vec3 low{at[0], at[1], at[2]}, high{at[4], at[5], at[6]};
    box = {low, high - low};
    at += 8;
  }
}

}  // namespace weft_godot
