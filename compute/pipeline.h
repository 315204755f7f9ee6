// From SPIR-V and specialisation constants to a compute pipeline, and a cache of compiled pipelines on disk.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "compute/owned.h"
#include "compute/specialize.h"

namespace weft::compute {

/// A VkPipelineCache, and the modules specialised for the device (Specializer), that outlive the process. The file carries both
/// behind a header (device, driver, cache UUID, lengths, checksum); a file that does not fit is ignored, counted, and replaced at
/// the next save: a stale cache costs time, never correctness.
class PipelineCache {
 public:
  /// An empty path keeps the cache in memory only. A missing file is no error.
  static Result<PipelineCache> create(const Device& device, const std::filesystem::path& path = {});
  PipelineCache() = default;

  VkPipelineCache handle() const { return cache_.get(); }
  /// Bytes that came from the file.
  size_t loaded_bytes() const { return loaded_bytes_; }
  /// 1 when there was a file that could not be used, else 0.
  uint32_t broken_files() const { return broken_files_; }
  /// Why, as a sentence.
  const std::string& refusal() const { return refusal_; }

  /// Written beside the file and renamed, so that a reader never sees half of it. Makes the directory. Nothing is written where
  /// nothing has changed.
  Result<void> save() const;

 private:
  const Device* device_ = nullptr;
  OwnedPipelineCache cache_;
  std::filesystem::path path_;
  size_t loaded_bytes_ = 0, loaded_specialized_bytes_ = 0;   // of all, and of what was specialised
  uint32_t broken_files_ = 0;
  std::string refusal_;
};

class ComputePipeline {
 public:
  /// The entry point is "main". `cache` may be null.
  static Result<ComputePipeline> create(const Device& device, const PipelineCache* cache, std::string_view name,
                                        std::span<const uint32_t> spirv,
                                        std::span<const SpecializationConstant> constants, VkPipelineLayout layout);
  ComputePipeline() = default;

  VkPipeline handle() const { return pipeline_.get(); }

 private:
  OwnedPipeline pipeline_;
};

Result<OwnedShaderModule> create_shader_module(const Device& device, std::string_view name,
                                               std::span<const uint32_t> spirv);

}  // namespace weft::compute
