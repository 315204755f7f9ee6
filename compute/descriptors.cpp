// Descriptor layouts and sets. See descriptors.h.
#include "compute/descriptors.h"

#include <algorithm>
#include <map>

namespace weft::compute {
namespace {

bool is_texel(VkDescriptorType type) {
  return type == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER || type == VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
}

const DescriptorBinding* find(std::span<const DescriptorBinding> bindings, uint32_t number) {
  const auto found = std::find_if(bindings.begin(), bindings.end(),
                                  [&](const DescriptorBinding& binding) { return binding.binding == number; });
  return found == bindings.end() ? nullptr : &*found;
}

}  // namespace

VkDescriptorType descriptor_type(Binding::Kind kind) {
  switch (kind) {
    case Binding::Kind::storage_buffer: return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    case Binding::Kind::uniform_buffer: return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    case Binding::Kind::uniform_texel_buffer: return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    case Binding::Kind::storage_texel_buffer: return VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
    case Binding::Kind::combined_image: return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    case Binding::Kind::sampled_image: return VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
    case Binding::Kind::storage_image: return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    case Binding::Kind::sampler: return VK_DESCRIPTOR_TYPE_SAMPLER;
    case Binding::Kind::other: break;
  }
  return VK_DESCRIPTOR_TYPE_MAX_ENUM;
}

Result<DescriptorLayout> DescriptorLayout::create(const Device& device, std::string_view name,
                                                  std::span<const DescriptorBinding> bindings,
                                                  VkShaderStageFlags stages) {
  std::vector<VkDescriptorSetLayoutBinding> slots;
  uint32_t storage_buffers = 0;
  for (const DescriptorBinding& binding : bindings) {
    slots.push_back({binding.binding, binding.type, 1, stages, nullptr});
    if (binding.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER) ++storage_buffers;
  }
  if (storage_buffers > device.limits().max_storage_buffers_per_stage) {
    return fail("descriptor layout ", name, " has ", storage_buffers, " storage buffers, above ",
                device.limits().max_storage_buffers_per_stage, ", the maxPerStageDescriptorStorageBuffers of ",
                device.name());
  }
  auto create = typed<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  create.bindingCount = static_cast<uint32_t>(slots.size());
  create.pBindings = slots.data();
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  const VkResult result = device.vk().vkCreateDescriptorSetLayout(device.handle(), &create, nullptr, &layout);
  if (result != VK_SUCCESS) return fail("descriptor layout ", name, " could not be created: ", result_name(result));
  device.name_object(VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT, layout, name);
  DescriptorLayout made;
  made.layout_ = OwnedSetLayout(device, layout);
  made.bindings_.assign(bindings.begin(), bindings.end());
  return made;
}

Result<OwnedPipelineLayout> create_pipeline_layout(const Device& device, std::string_view name,
                                                   std::span<const VkDescriptorSetLayout> sets,
                                                   uint32_t push_constant_bytes, VkShaderStageFlags stages) {
  if (push_constant_bytes > device.limits().max_push_constant_bytes) {
    return fail("pipeline layout ", name, " has ", push_constant_bytes, " bytes of push constants, above ",
                device.limits().max_push_constant_bytes, ", the maxPushConstantsSize of ", device.name());
  }
  const VkPushConstantRange range{stages, 0, push_constant_bytes};
  auto create = typed<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  create.setLayoutCount = static_cast<uint32_t>(sets.size());
  create.pSetLayouts = sets.data();
  create.pushConstantRangeCount = push_constant_bytes > 0 ? 1 : 0;
  create.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  const VkResult result = device.vk().vkCreatePipelineLayout(device.handle(), &create, nullptr, &layout);
  if (result != VK_SUCCESS) return fail("pipeline layout ", name, " could not be created: ", result_name(result));
  device.name_object(VK_OBJECT_TYPE_PIPELINE_LAYOUT, layout, name);
  return OwnedPipelineLayout(device, layout);
}

Result<DescriptorSet> DescriptorSet::create(const Device& device, std::string_view name, const DescriptorLayout& layout,
                                            std::span<const BoundBuffer> buffers) {
  const Functions& fn = device.vk();
  std::map<VkDescriptorType, uint32_t> counts;
  for (const DescriptorBinding& binding : layout.bindings()) ++counts[binding.type];
  std::vector<VkDescriptorPoolSize> sizes;
  for (const auto& [type, count] : counts) sizes.push_back({type, count});
  // A pool must have a size even for a layout without bindings.
  if (sizes.empty()) sizes.push_back({VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1});
  auto create = typed<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  create.maxSets = 1;
  create.poolSizeCount = static_cast<uint32_t>(sizes.size());
  create.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  const VkResult pooled = fn.vkCreateDescriptorPool(device.handle(), &create, nullptr, &pool);
  if (pooled != VK_SUCCESS) return fail("descriptor pool ", name, " could not be created: ", result_name(pooled));
  device.name_object(VK_OBJECT_TYPE_DESCRIPTOR_POOL, pool, name);
  DescriptorSet made;
  made.pool_ = OwnedDescriptorPool(device, pool);
  const VkDescriptorSetLayout layout_handle = layout.handle();
  auto allocate = typed<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  allocate.descriptorPool = pool;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout_handle;
  const VkResult allocated = fn.vkAllocateDescriptorSets(device.handle(), &allocate, &made.set_);
  if (allocated != VK_SUCCESS) return fail("descriptor set ", name, " could not be made: ", result_name(allocated));
  device.name_object(VK_OBJECT_TYPE_DESCRIPTOR_SET, made.set_, name);

  std::vector<VkWriteDescriptorSet> writes;
  std::vector<VkDescriptorBufferInfo> parts(buffers.size());
  for (size_t i = 0; i < buffers.size(); ++i) {
    const BoundBuffer& bound = buffers[i];
    const DescriptorBinding* binding = find(layout.bindings(), bound.binding);
    if (binding == nullptr) {
      return fail("descriptor set ", name, " has no binding ", bound.binding, " for buffer ", bound.buffer->name);
    }
    if (is_texel(binding->type) && bound.buffer->view == VK_NULL_HANDLE) {
      return fail("binding ", bound.binding, " of descriptor set ", name, " is a texel buffer, and buffer ",
                  bound.buffer->name, " was created without a texel format");
    }
    parts[i] = {bound.buffer->handle, bound.offset, bound.bytes};
    auto write = typed<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
    write.dstSet = made.set_;
    write.dstBinding = bound.binding;
    write.descriptorCount = 1;
    write.descriptorType = binding->type;
    write.pBufferInfo = &parts[i];
    write.pTexelBufferView = &bound.buffer->view;
    writes.push_back(write);
  }
  fn.vkUpdateDescriptorSets(device.handle(), static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
  return made;
}

}  // namespace weft::compute
