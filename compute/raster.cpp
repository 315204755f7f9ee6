#include "compute/raster.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "compute/buffer.h"
#include "compute/commands.h"
#include "compute/pipeline.h"

namespace weft::compute {
namespace {

Error refused(std::string_view what, std::string_view name, VkResult result) {
  return fail(what, " \"", name, "\" could not be made: ", result_name(result));
}

// Memory in which an image may lie, near the GPU if there is a choice.
uint32_t memory_type(const Device& device, uint32_t allowed) {
  const VkPhysicalDeviceMemoryProperties& memory = device.memory();
  uint32_t found = VK_MAX_MEMORY_TYPES;
  for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if (!(allowed >> i & 1)) continue;
    if (memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) return i;
    if (found == VK_MAX_MEMORY_TYPES) found = i;
  }
  return found;
}

VkRenderingAttachmentInfo attachment(const DeviceImage& image, VkImageLayout layout, bool keep) {
  auto info = typed<VkRenderingAttachmentInfo>(VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO);
  info.imageView = image.view();
  info.imageLayout = layout;
  info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  info.storeOp = keep ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_DONT_CARE;
  return info;
}

bool is_image(VkDescriptorType type) {
  return type != VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER && type != VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

}  // namespace

VkImageAspectFlags DeviceImage::aspect() const {
  return request_.usage & VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

Result<DeviceImage> DeviceImage::create(const Device& device, const ImageRequest& request) {
  DeviceImage made;
  made.request_ = request;
  auto info = typed<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = request.format;
  info.extent = {request.size.width, request.size.height, 1};
  info.mipLevels = request.levels;
  info.arrayLayers = 1;
  info.samples = request.samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = request.usage;
  info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  const uint32_t largest = device.properties().limits.maxImageDimension2D;
  if (request.size.width > largest || request.size.height > largest)
    return fail("image \"", request.name, "\" is ", request.size.width, " x ", request.size.height, " pixels, but ", device.name(),
                " takes at most ", largest, " a side");
  VkImage image = VK_NULL_HANDLE;
  if (VkResult r = device.vk().vkCreateImage(device.handle(), &info, nullptr, &image))
    return refused("image", request.name, r);
  made.image_ = OwnedImage(device, image);
  device.name_object(VK_OBJECT_TYPE_IMAGE, image, request.name);

  VkMemoryRequirements needs;
  device.vk().vkGetImageMemoryRequirements(device.handle(), image, &needs);
  auto allocate = typed<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = memory_type(device, needs.memoryTypeBits);
  VkDeviceMemory memory = VK_NULL_HANDLE;
  if (VkResult r = device.vk().vkAllocateMemory(device.handle(), &allocate, nullptr, &memory))
    return fail(needs.size, " bytes for image \"", request.name, "\" could not be allocated: ", result_name(r));
  made.memory_ = OwnedMemory(device, memory);
  device.name_object(VK_OBJECT_TYPE_DEVICE_MEMORY, memory, request.name);
  if (VkResult r = device.vk().vkBindImageMemory(device.handle(), image, memory, 0))
    return refused("memory of image", request.name, r);

  auto view = typed<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  view.image = image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = request.format;
  view.subresourceRange = {made.aspect(), 0, request.levels, 0, 1};
  VkImageView handle = VK_NULL_HANDLE;
  if (VkResult r = device.vk().vkCreateImageView(device.handle(), &view, nullptr, &handle))
    return refused("image view", request.name, r);
  made.view_ = OwnedImageView(device, handle);
  device.name_object(VK_OBJECT_TYPE_IMAGE_VIEW, handle, request.name);
  return made;
}

void change_use(const Device& device, VkCommandBuffer commands, const DeviceImage& image, const ImageUse& from,
                const ImageUse& to) {
  auto barrier = typed<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
  barrier.srcStageMask = from.stages;
  barrier.srcAccessMask = from.access;
  barrier.dstStageMask = to.stages;
  barrier.dstAccessMask = to.access;
  barrier.oldLayout = from.layout;
  barrier.newLayout = to.layout;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.handle();
  barrier.subresourceRange = {image.aspect(), 0, image.request().levels, 0, 1};
  auto dependency = typed<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  device.vk().vkCmdPipelineBarrier2(commands, &dependency);
}

Result<DeviceImage> create_texture(const Device& device, std::string_view name, VkFormat format, VkExtent2D size,
                                   std::span<const std::vector<std::byte>> levels) {
  ImageRequest request{std::string(name), format, size, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
  request.levels = static_cast<uint32_t>(levels.size());
  auto image = DeviceImage::create(device, request);
  if (!image) return image.take_error();

  std::vector<BufferRequest> requests;
  for (const auto& level : levels) requests.push_back({request.name + " staging", level.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT});
  auto staging = Arena::create(device, Memory::upload, request.name + " staging", requests);
  if (!staging) return staging.take_error();
  for (size_t i = 0; i < levels.size(); ++i) std::memcpy((*staging)[i].mapped, levels[i].data(), levels[i].size());

  auto copied = run_once(device, request.name + " upload", [&](VkCommandBuffer commands) {
    change_use(device, commands, *image, kUnused, kCopyDestination);
    for (uint32_t i = 0; i < request.levels; ++i) {
      VkBufferImageCopy copy{};
      copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, i, 0, 1};
      copy.imageExtent = {std::max(size.width >> i, 1u), std::max(size.height >> i, 1u), 1};
      device.vk().vkCmdCopyBufferToImage(commands, (*staging)[i].handle, image->handle(), kCopyDestination.layout, 1, &copy);
    }
    change_use(device, commands, *image, kCopyDestination, kSampled);
  });
  if (!copied) return copied.take_error();
  return image;
}

Result<OwnedSampler> create_sampler(const Device& device, std::string_view name, const SamplerRequest& request) {
  auto info = typed<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
  info.magFilter = info.minFilter = request.linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.mipmapMode = request.linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = info.addressModeV = info.addressModeW =
      request.repeat ? VK_SAMPLER_ADDRESS_MODE_REPEAT : VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.compareEnable = request.compare;
  info.compareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
  info.maxLod = VK_LOD_CLAMP_NONE;
  VkSampler sampler = VK_NULL_HANDLE;
  if (VkResult r = device.vk().vkCreateSampler(device.handle(), &info, nullptr, &sampler))
    return refused("sampler", name, r);
  device.name_object(VK_OBJECT_TYPE_SAMPLER, sampler, name);
  return OwnedSampler(device, sampler);
}

Result<DrawSet> DrawSet::create(const Device& device, std::string_view name, const DescriptorLayout& layout,
                                std::span<const DrawBinding> bindings) {
  std::vector<VkDescriptorPoolSize> sizes;
  for (const DescriptorBinding& binding : layout.bindings()) sizes.push_back({binding.type, 1});
  auto info = typed<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  info.maxSets = 1;
  info.poolSizeCount = static_cast<uint32_t>(sizes.size());
  info.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  if (VkResult r = device.vk().vkCreateDescriptorPool(device.handle(), &info, nullptr, &pool))
    return refused("descriptor pool", name, r);
  DrawSet made;
  made.pool_ = OwnedDescriptorPool(device, pool);
  device.name_object(VK_OBJECT_TYPE_DESCRIPTOR_POOL, pool, name);

  VkDescriptorSetLayout handle = layout.handle();
  auto allocate = typed<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  allocate.descriptorPool = pool;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &handle;
  if (VkResult r = device.vk().vkAllocateDescriptorSets(device.handle(), &allocate, &made.set_))
    return refused("descriptor set", name, r);
  device.name_object(VK_OBJECT_TYPE_DESCRIPTOR_SET, made.set_, name);

  std::vector<VkWriteDescriptorSet> writes;
  for (const DrawBinding& bound : bindings) {
    auto write = typed<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
    write.descriptorType = VK_DESCRIPTOR_TYPE_MAX_ENUM;
    for (const DescriptorBinding& binding : layout.bindings())
      if (binding.binding == bound.binding) write.descriptorType = binding.type;
    if (write.descriptorType == VK_DESCRIPTOR_TYPE_MAX_ENUM)
      return fail("descriptor set \"", name, "\" has no binding ", bound.binding);
    write.dstSet = made.set_;
    write.dstBinding = bound.binding;
    write.descriptorCount = 1;
    if (is_image(write.descriptorType))
      write.pImageInfo = &bound.image;
    else
      write.pBufferInfo = &bound.buffer;
    writes.push_back(write);
  }
  device.vk().vkUpdateDescriptorSets(device.handle(), static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
  return made;
}

Result<OwnedPipeline> create_draw_pipeline(const Device& device, const DrawPipelineRequest& request) {
  auto vertex = create_shader_module(device, request.name + " vertex", request.vertex);
  if (!vertex) return vertex.take_error();
  OwnedShaderModule fragment;
  if (!request.fragment.empty()) {
    auto module = create_shader_module(device, request.name + " fragment", request.fragment);
    if (!module) return module.take_error();
    fragment = std::move(*module);
  }
  VkPipelineShaderStageCreateInfo stages[2] = {};
  stages[0].sType = stages[1].sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = vertex->get();
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = fragment.get();
  stages[0].pName = stages[1].pName = "main";

  auto input = typed<VkPipelineVertexInputStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  input.vertexBindingDescriptionCount = static_cast<uint32_t>(request.bindings.size());
  input.pVertexBindingDescriptions = request.bindings.data();
  input.vertexAttributeDescriptionCount = static_cast<uint32_t>(request.attributes.size());
  input.pVertexAttributeDescriptions = request.attributes.data();
  auto assembly = typed<VkPipelineInputAssemblyStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  auto viewport = typed<VkPipelineViewportStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = viewport.scissorCount = 1;
  auto raster = typed<VkPipelineRasterizationStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.cullMode = request.cull;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.depthBiasEnable = request.bias != 0 || request.slope_bias != 0;
  raster.depthBiasConstantFactor = request.bias;
  raster.depthBiasSlopeFactor = request.slope_bias;
  raster.lineWidth = 1;
  auto multisample = typed<VkPipelineMultisampleStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  multisample.rasterizationSamples = request.samples;
  auto depth = typed<VkPipelineDepthStencilStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = request.depth != VK_FORMAT_UNDEFINED;
  depth.depthWriteEnable = request.depth_write;
  depth.depthCompareOp = request.compare;
  VkPipelineColorBlendAttachmentState all{};
  all.colorWriteMask = 0xf;
  auto blend = typed<VkPipelineColorBlendStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = request.colour == VK_FORMAT_UNDEFINED ? 0 : 1;
  blend.pAttachments = &all;
  const VkDynamicState set_later[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  auto dynamic = typed<VkPipelineDynamicStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = set_later;
  auto rendering = typed<VkPipelineRenderingCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO);
  rendering.colorAttachmentCount = blend.attachmentCount;
  rendering.pColorAttachmentFormats = &request.colour;
  rendering.depthAttachmentFormat = request.depth;

  auto info = typed<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.pNext = &rendering;
  info.stageCount = fragment ? 2 : 1;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &multisample;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = request.layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  if (VkResult r = device.vk().vkCreateGraphicsPipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline))
    return refused("graphics pipeline", request.name, r);
  device.name_object(VK_OBJECT_TYPE_PIPELINE, pipeline, request.name);
  return OwnedPipeline(device, pipeline);
}

void begin_drawing(const Device& device, VkCommandBuffer commands, const DrawTargets& targets) {
  assert(targets.colour || targets.depth);
  const VkExtent2D size = (targets.colour ? targets.colour : targets.depth)->request().size;
  VkRenderingAttachmentInfo colour{}, depth{};
  auto info = typed<VkRenderingInfo>(VK_STRUCTURE_TYPE_RENDERING_INFO);
  info.renderArea = {{0, 0}, size};
  info.layerCount = 1;
  if (targets.colour) {
    colour = attachment(*targets.colour, kColourTarget.layout, !targets.resolve);
    if (targets.resolve) {
      colour.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
      colour.resolveImageView = targets.resolve->view();
      colour.resolveImageLayout = kColourTarget.layout;
    }
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &colour;
  }
  if (targets.depth) {
    depth = attachment(*targets.depth, kDepthTarget.layout, targets.keep_depth);
    depth.clearValue.depthStencil.depth = targets.clear_depth;
    info.pDepthAttachment = &depth;
  }
  device.vk().vkCmdBeginRendering(commands, &info);
  const VkViewport viewport{0, 0, static_cast<float>(size.width), static_cast<float>(size.height), 0, 1};
  device.vk().vkCmdSetViewport(commands, 0, 1, &viewport);
  device.vk().vkCmdSetScissor(commands, 0, 1, &info.renderArea);
}

void end_drawing(const Device& device, VkCommandBuffer commands) { device.vk().vkCmdEndRendering(commands); }

}  // namespace weft::compute
