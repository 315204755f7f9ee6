// Descriptor layouts, and sets that are written once at create.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "compute/buffer.h"
#include "compute/reflect.h"

namespace weft::compute {

struct DescriptorBinding {
  uint32_t binding = 0;
  VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
};

/// The Vulkan type of a reflected binding; VK_DESCRIPTOR_TYPE_MAX_ENUM for Kind::other.
VkDescriptorType descriptor_type(Binding::Kind kind);

class DescriptorLayout {
 public:
  static Result<DescriptorLayout> create(const Device& device, std::string_view name,
                                         std::span<const DescriptorBinding> bindings,
                                         VkShaderStageFlags stages = VK_SHADER_STAGE_COMPUTE_BIT);
  DescriptorLayout() = default;
  VkDescriptorSetLayout handle() const { return layout_.get(); }
  std::span<const DescriptorBinding> bindings() const { return bindings_; }

 private:
  OwnedSetLayout layout_;
  std::vector<DescriptorBinding> bindings_;
};

/// Sets in order, one push block from offset 0.
Result<OwnedPipelineLayout> create_pipeline_layout(const Device& device, std::string_view name,
                                                   std::span<const VkDescriptorSetLayout> sets,
                                                   uint32_t push_constant_bytes = 0,
                                                   VkShaderStageFlags stages = VK_SHADER_STAGE_COMPUTE_BIT);

/// `buffer` is bound from `offset` on, by its view, whole, where the binding is a texel buffer.
struct BoundBuffer {
  uint32_t binding = 0;
  const Buffer* buffer = nullptr;
  VkDeviceSize offset = 0;
  VkDeviceSize bytes = VK_WHOLE_SIZE;
};

/// One set with a pool of exactly its size.
class DescriptorSet {
 public:
  /// Errors: a buffer for a binding the layout does not have, a texel binding whose buffer has no view.
  static Result<DescriptorSet> create(const Device& device, std::string_view name, const DescriptorLayout& layout,
                                      std::span<const BoundBuffer> buffers);
  DescriptorSet() = default;
  VkDescriptorSet handle() const { return set_; }

 private:
  OwnedDescriptorPool pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace weft::compute
