// A host that skins on its own GPU: a compute shader of its own writes where render vertices are, into a buffer that Weft is told of.
#pragma once

#include <bit>
#include <memory>
#include <span>
#include <vector>

#include "compute/buffer.h"
#include "compute/commands.h"
#include "compute/descriptors.h"
#include "compute/pipeline.h"
#include "compute/recorder.h"
#include "engine/simulation.h"
#include "scale.h"
#include "tests/support/must.h"

namespace weft {

class HostSkinning {
 public:
  /// `entries`: of positions and, where it has them, of normals behind these.
  HostSkinning(const compute::Device& device, std::uint32_t vertices, bool with_normals)
      : device_(device), vertices_(vertices), words_(4 * vertices * (with_normals ? 2 : 1)) {
    const compute::BufferRequest request{"host targets", kOffset + 4 * words_,
                                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    buffer_ = must(compute::Arena::create(device, compute::Memory::device, "host", std::span(&request, 1)));
    const compute::DescriptorBinding binding{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
    layout_ = must(compute::DescriptorLayout::create(device, "host", std::span(&binding, 1)));
    const VkDescriptorSetLayout handle = layout_.handle();
    pipeline_layout_ = must(compute::create_pipeline_layout(device, "host", {&handle, 1}, 2 * sizeof(std::uint32_t)));
    const compute::SpecializationConstant constants[] = {{0, 64}, {1, 1}};
    pipeline_ = must(compute::ComputePipeline::create(device, nullptr, "host", scale, constants, pipeline_layout_.get()));
    const compute::BoundBuffer bound{0, &buffer_[0], kOffset, 4 * words_};
    set_ = must(compute::DescriptorSet::create(device, "host", layout_, std::span(&bound, 1)));
  }

  /// Its shader adds a number to the bits of what it is given: what Weft reads is what a shader has written.
  void record(VkCommandBuffer commands, std::span<const Vec3> positions, std::span<const Vec3> normals = {}) const {
    std::vector<std::uint32_t> words;
    for (const auto list : {positions, normals})
      for (const Vec3& v : list)
        for (const float x : {v.x, v.y, v.z, 1e30f}) words.push_back(std::bit_cast<std::uint32_t>(x) - kTerm);
    device_.vk().vkCmdUpdateBuffer(commands, buffer_[0].handle, kOffset, 4 * words.size(), words.data());
    compute::Recorder(device_, commands).barrier(compute::Use::transfer, compute::Use::compute);
    const VkDescriptorSet set = set_.handle();
    const std::uint32_t push[] = {static_cast<std::uint32_t>(words.size()), kTerm};
    device_.vk().vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_.handle());
    device_.vk().vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_layout_.get(), 0, 1, &set, 0, nullptr);
    device_.vk().vkCmdPushConstants(commands, pipeline_layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, push);
    device_.vk().vkCmdDispatch(commands, static_cast<std::uint32_t>(words.size() + 63) / 64, 1, 1);
  }
  /// In a submit of its own, before the frame's.
  void run(std::span<const Vec3> positions, std::span<const Vec3> normals = {}) const {
    must(compute::run_once(device_, "host skinning", [&](VkCommandBuffer commands) { record(commands, positions, normals); }));
  }

  TargetBuffer targets() const {
    const VkBuffer normals = words_ > 4 * vertices_ ? buffer_[0].handle : VK_NULL_HANDLE;
    return {buffer_[0].handle, kOffset, normals, kOffset + 16 * VkDeviceSize{vertices_}, vertices_};
  }
  const compute::Buffer& buffer() const { return buffer_[0]; }

 private:
  static constexpr VkDeviceSize kOffset = 256;
  static constexpr std::uint32_t kTerm = 12345;

  const compute::Device& device_;
  std::uint32_t vertices_ = 0, words_ = 0;
  compute::Arena buffer_;
  compute::DescriptorLayout layout_;
  compute::OwnedPipelineLayout pipeline_layout_;
  compute::ComputePipeline pipeline_;
  compute::DescriptorSet set_;
};

}  // namespace weft
