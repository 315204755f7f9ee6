// See samples/host_engine/renderer.h.
#include "samples/host_engine/renderer.h"

#include <cmath>
#include <cstddef>

#include "host_engine.frag.h"
#include "host_engine.vert.h"

namespace host {
namespace {

constexpr VkFormat kColour = VK_FORMAT_R8G8B8A8_SRGB, kDepth = VK_FORMAT_D32_SFLOAT;
constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;
constexpr VkClearColorValue kHaze{{0.55f, 0.63f, 0.72f, 1}};   // as in host_engine.frag
constexpr float kFieldOfView = 0.7f;                            // rad, vertical
constexpr float kNear = 0.1f, kFar = 60;                        // m
constexpr float kShadowHeight = 0.004f;                         // m above the floor: clear of it in the depth buffer
constexpr Vec3 kShadow{0.10f, 0.10f, 0.11f};

struct Push {
  Mat4 to_clip;
  float place[4], scale[4], colour[4], sun[4];
};
static_assert(sizeof(Push) == 128);   // all that every device has

Vec3 unit(Vec3 v) { return (1 / weft::length(v)) * v; }

Mat4 product(const Mat4& a, const Mat4& b) {
  Mat4 c{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 4; ++k) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return c;
}

// World to clip space: y down, depth 0 near and 1 far.
Mat4 camera(const Stage& stage, float aspect) {
  const Vec3 back = unit(stage.eye - stage.target), right = unit(cross(Vec3{0, 1, 0}, back)), up = cross(back, right);
  const Mat4 view{right.x, up.x, back.x, 0, right.y, up.y, back.y, 0, right.z, up.z, back.z, 0,
                  -dot(right, stage.eye), -dot(up, stage.eye), -dot(back, stage.eye), 1};
  const float f = 1 / std::tan(kFieldOfView / 2);
  const Mat4 projection{f / aspect, 0, 0, 0, 0, -f, 0, 0, 0, 0, kFar / (kNear - kFar), -1, 0, 0, kNear * kFar / (kNear - kFar), 0};
  return product(projection, view);
}

// Along the sun's light onto the plane y = kShadowHeight.
Mat4 flatten(Vec3 sun) {
  const float x = sun.x / sun.y, z = sun.z / sun.y;
  return {1, 0, 0, 0, -x, 0, -z, 0, 0, 0, 1, 0, x * kShadowHeight, kShadowHeight, z * kShadowHeight, 1};
}

void change(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to,
            VkPipelineStageFlags2 before, VkAccessFlags2 written, VkPipelineStageFlags2 after, VkAccessFlags2 touched) {
  auto barrier = typed<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
  barrier.srcStageMask = before;
  barrier.srcAccessMask = written;
  barrier.dstStageMask = after;
  barrier.dstAccessMask = touched;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {aspect, 0, 1, 0, 1};
  auto dependency = typed<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &dependency);
}

Result<VkShaderModule> create_module(VkDevice device, std::span<const std::uint32_t> words) {
  auto create = typed<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  create.codeSize = words.size_bytes();
  create.pCode = words.data();
  VkShaderModule module = VK_NULL_HANDLE;
  if (auto done = checked(vkCreateShaderModule(device, &create, nullptr, &module), "vkCreateShaderModule"); !done) return done.take_error();
  return module;
}

}  // namespace

Result<std::unique_ptr<Renderer>> Renderer::create(const Device& device, VkExtent2D size) {
  std::unique_ptr<Renderer> made(new Renderer(device, size));
  constexpr VkImageUsageFlags kAttachment = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  if (auto done = made->create_target(made->colour_, kColour, kSamples, kAttachment); !done) return done.take_error();
  if (auto done = made->create_target(made->depth_, kDepth, kSamples, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT); !done)
    return done.take_error();
  if (auto done = made->create_target(made->picture_, kColour, VK_SAMPLE_COUNT_1_BIT, kAttachment | VK_IMAGE_USAGE_TRANSFER_SRC_BIT); !done)
    return done.take_error();
  auto pixels = Buffer::create(device, VkDeviceSize{4} * size.width * size.height, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  if (!pixels) return pixels.take_error();
  made->pixels_ = std::move(*pixels);
  if (auto done = made->create_pipeline(); !done) return done.take_error();
  return made;
}

Renderer::~Renderer() {
  const VkDevice device = device_->handle();
  vkDestroyPipeline(device, pipeline_, nullptr);
  vkDestroyPipelineLayout(device, layout_, nullptr);
  for (const Target& target : {colour_, depth_, picture_}) {
    vkDestroyImageView(device, target.view, nullptr);
    vkDestroyImage(device, target.image, nullptr);
    vkFreeMemory(device, target.memory, nullptr);
  }
}

Result<void> Renderer::create_target(Target& target, VkFormat format, VkSampleCountFlagBits samples, VkImageUsageFlags usage) {
  const VkDevice device = device_->handle();
  auto create = typed<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  create.imageType = VK_IMAGE_TYPE_2D;
  create.format = format;
  create.extent = {size_.width, size_.height, 1};
  create.mipLevels = create.arrayLayers = 1;
  create.samples = samples;
  create.usage = usage;
  if (auto done = checked(vkCreateImage(device, &create, nullptr, &target.image), "vkCreateImage"); !done) return done;
  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(device, target.image, &needs);
  auto type = device_->memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (!type) return type.take_error();
  auto allocate = typed<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = *type;
  if (auto done = checked(vkAllocateMemory(device, &allocate, nullptr, &target.memory), "vkAllocateMemory"); !done) return done;
  if (auto done = checked(vkBindImageMemory(device, target.image, target.memory, 0), "vkBindImageMemory"); !done) return done;
  auto view = typed<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  view.image = target.image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format;
  const VkImageAspectFlags aspect = format == kDepth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  view.subresourceRange = {aspect, 0, 1, 0, 1};
  return checked(vkCreateImageView(device, &view, nullptr, &target.view), "vkCreateImageView");
}

Result<void> Renderer::create_pipeline() {
  const VkDevice device = device_->handle();
  const VkPushConstantRange range{VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(Push)};
  auto layout = typed<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &range;
  if (auto done = checked(vkCreatePipelineLayout(device, &layout, nullptr, &layout_), "vkCreatePipelineLayout"); !done) return done;

  auto vertex = create_module(device, sample_host_engine_vert);
  if (!vertex) return vertex.take_error();
  auto fragment = create_module(device, sample_host_engine_frag);
  if (!fragment) {
    vkDestroyShaderModule(device, *vertex, nullptr);
    return fragment.take_error();
  }
  VkPipelineShaderStageCreateInfo stages[] = {typed<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO),
                                              typed<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO)};
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = *vertex;
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = *fragment;
  stages[0].pName = stages[1].pName = "main";

  const weft::FrameView as_weft;   // stride and format that every attribute has
  const VkVertexInputBindingDescription bindings[] = {{0, as_weft.stride, VK_VERTEX_INPUT_RATE_VERTEX},
                                                      {1, as_weft.stride, VK_VERTEX_INPUT_RATE_VERTEX}};
  const VkVertexInputAttributeDescription attributes[] = {{0, 0, as_weft.format, 0}, {1, 1, as_weft.format, 0}};
  auto input = typed<VkPipelineVertexInputStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  input.vertexBindingDescriptionCount = input.vertexAttributeDescriptionCount = 2;
  input.pVertexBindingDescriptions = bindings;
  input.pVertexAttributeDescriptions = attributes;
  auto assembly = typed<VkPipelineInputAssemblyStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  const VkViewport area{0, 0, static_cast<float>(size_.width), static_cast<float>(size_.height), 0, 1};
  const VkRect2D scissor{{0, 0}, size_};
  auto viewport = typed<VkPipelineViewportStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = viewport.scissorCount = 1;
  viewport.pViewports = &area;
  viewport.pScissors = &scissor;
  auto raster = typed<VkPipelineRasterizationStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.lineWidth = 1;   // nothing is culled: cloth has two sides
  auto samples = typed<VkPipelineMultisampleStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  samples.rasterizationSamples = kSamples;
  auto depth = typed<VkPipelineDepthStencilStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_LESS;
  VkPipelineColorBlendAttachmentState opaque{};
  opaque.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  auto blend = typed<VkPipelineColorBlendStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = 1;
  blend.pAttachments = &opaque;
  auto formats = typed<VkPipelineRenderingCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO);
  formats.colorAttachmentCount = 1;
  formats.pColorAttachmentFormats = &kColour;
  formats.depthAttachmentFormat = kDepth;

  auto create = typed<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  create.pNext = &formats;
  create.stageCount = 2;
  create.pStages = stages;
  create.pVertexInputState = &input;
  create.pInputAssemblyState = &assembly;
  create.pViewportState = &viewport;
  create.pRasterizationState = &raster;
  create.pMultisampleState = &samples;
  create.pDepthStencilState = &depth;
  create.pColorBlendState = &blend;
  create.layout = layout_;
  const VkResult result = vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &create, nullptr, &pipeline_);
  vkDestroyShaderModule(device, *vertex, nullptr);
  vkDestroyShaderModule(device, *fragment, nullptr);
  return checked(result, "vkCreateGraphicsPipelines");
}

void Renderer::draw(VkCommandBuffer commands, const Stage& stage, std::span<const Drawable> drawables) const {
  // What the frame before drew is overwritten, once it has been drawn and copied.
  constexpr VkPipelineStageFlags2 kOutput = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  constexpr VkPipelineStageFlags2 kTests = VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
  constexpr VkAccessFlags2 kColourWrite = VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;
  constexpr VkAccessFlags2 kDepthWrite = VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  for (const Target& target : {colour_, picture_})
    change(commands, target.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
           kOutput | VK_PIPELINE_STAGE_2_COPY_BIT, kColourWrite, kOutput, kColourWrite);
  change(commands, depth_.image, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, kTests,
         kDepthWrite, kTests, kDepthWrite | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT);

  auto colour = typed<VkRenderingAttachmentInfo>(VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO);
  colour.imageView = colour_.view;
  colour.imageLayout = colour.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  colour.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
  colour.resolveImageView = picture_.view;
  colour.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  colour.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  colour.clearValue.color = kHaze;
  auto depth = typed<VkRenderingAttachmentInfo>(VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO);
  depth.imageView = depth_.view;
  depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
  depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  depth.clearValue.depthStencil = {1, 0};
  auto rendering = typed<VkRenderingInfo>(VK_STRUCTURE_TYPE_RENDERING_INFO);
  rendering.renderArea = {{0, 0}, size_};
  rendering.layerCount = 1;
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachments = &colour;
  rendering.pDepthAttachment = &depth;

  const Vec3 sun = unit(stage.sun);
  const Mat4 to_clip = camera(stage, static_cast<float>(size_.width) / static_cast<float>(size_.height));
  const Mat4 shadow_to_clip = product(to_clip, flatten(sun));
  vkCmdBeginRendering(commands, &rendering);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
  for (const Drawable& what : drawables) {
    draw_one(commands, what, to_clip, what.colour, true, sun);
    if (what.casts) draw_one(commands, what, shadow_to_clip, kShadow, false, sun);
  }
  vkCmdEndRendering(commands);
}

void Renderer::draw_one(VkCommandBuffer commands, const Drawable& what, const Mat4& to_clip, Vec3 colour, bool lit, Vec3 sun) const {
  const Push push{to_clip,
                  {what.place.x, what.place.y, what.place.z, 0},
                  {what.scale.x, what.scale.y, what.scale.z, 0},
                  {colour.x, colour.y, colour.z, lit ? 1.0f : 0.0f},
                  {sun.x, sun.y, sun.z, 0}};
  vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof push, &push);
  const VkBuffer buffers[] = {what.positions.buffer, what.normals.buffer};
  const VkDeviceSize offsets[] = {what.positions.offset, what.normals.offset};
  vkCmdBindVertexBuffers(commands, 0, 2, buffers, offsets);
  vkCmdBindIndexBuffer(commands, what.indices, 0, VK_INDEX_TYPE_UINT32);
  vkCmdDrawIndexed(commands, what.index_count, 1, 0, 0, 0);
}

void Renderer::read_back(VkCommandBuffer commands) const {
  change(commands, picture_.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
         VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
         VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {size_.width, size_.height, 1};
  vkCmdCopyImageToBuffer(commands, picture_.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, pixels_.handle(), 1, &region);
  auto barrier = typed<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
  auto dependency = typed<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &dependency);
}

std::span<const std::byte> Renderer::pixels() const { return {pixels_.mapped(), std::size_t{4} * size_.width * size_.height}; }

}  // namespace host
