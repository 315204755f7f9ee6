// Compute pipelines and their cache on disk. See pipeline.h.
#include "compute/pipeline.h"

#include <cstddef>
#include <cstring>
#include <fstream>
#include <span>
#include <vector>

#include "compute/digest.h"
#include "compute/file.h"
#include "compute/reflect.h"

namespace weft::compute {
namespace {

/// Before what was specialised and the driver's blob. A driver update changes driver_version or the UUID, and so invalidates the file.
struct CacheHeader {
  char magic[8];
  uint32_t vendor;
  uint32_t device;
  uint32_t driver_version;
  uint32_t specialized_bytes;
  uint8_t uuid[VK_UUID_SIZE];
  uint64_t bytes;
  uint64_t checksum;
};
static_assert(sizeof(CacheHeader) == 56);

constexpr char kMagic[8] = {'W', 'E', 'F', 'T', 'P', 'C', '0', '2'};
constexpr uint64_t kMaxCacheBytes = uint64_t{256} << 20;  // a cache of Weft's few dozen kernels is far below this

uint64_t checksum(std::span<const std::byte> bytes) {
  Digest digest;
  digest.add(bytes);
  return digest.value();
}

CacheHeader header_for(const Device& device, std::span<const std::byte> content, uint32_t specialized_bytes) {
  CacheHeader header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.vendor = device.properties().vendorID;
  header.device = device.properties().deviceID;
  header.driver_version = device.properties().driverVersion;
  header.specialized_bytes = specialized_bytes;
  std::memcpy(header.uuid, device.properties().pipelineCacheUUID, VK_UUID_SIZE);
  header.bytes = content.size();
  header.checksum = checksum(content);
  return header;
}

struct CacheContent {
  std::vector<std::byte> bytes;
  uint32_t specialized_bytes = 0;   // at the front; the rest is the driver's
  std::span<const std::byte> blob() const { return std::span(bytes).subspan(specialized_bytes); }
};

Result<CacheContent> load(const Device& device, const std::filesystem::path& path) {
  std::error_code problem;
  const uint64_t size = std::filesystem::file_size(path, problem);
  const auto refuse = [&](const auto&... why) { return fail("pipeline cache ", path.string(), " is ignored: ", why...); };
  if (problem) return refuse(problem.message());
  if (size < sizeof(CacheHeader) || size > kMaxCacheBytes) {
    return refuse("it has ", size, " bytes, not between ", sizeof(CacheHeader), " and ", kMaxCacheBytes);
  }
  std::ifstream file(path, std::ios::binary);
  CacheHeader header{};
  CacheContent content;
  content.bytes.resize(size - sizeof header);
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  file.read(reinterpret_cast<char*>(content.bytes.data()), static_cast<std::streamsize>(content.bytes.size()));
  if (!file) return refuse("it could not be read");
  const CacheHeader expected = header_for(device, content.bytes, header.specialized_bytes);
  if (std::memcmp(header.magic, expected.magic, sizeof kMagic) != 0) return refuse("it is not a cache of this version of Weft");
  if (header.bytes != expected.bytes) {
    return refuse("it announces ", header.bytes, " bytes and holds ", expected.bytes);
  }
  if (header.checksum != expected.checksum) return refuse("its checksum does not fit its content");
  if (std::memcmp(&header, &expected, sizeof header) != 0) return refuse("it is of another device or driver");
  if (header.specialized_bytes > header.bytes)
    return refuse("what was specialised has more bytes than all of it: ", header.specialized_bytes);
  content.specialized_bytes = header.specialized_bytes;
  return content;
}

VkResult create_cache(const Device& device, std::span<const std::byte> blob, VkPipelineCache& cache) {
  auto create = typed<VkPipelineCacheCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO);
  create.initialDataSize = blob.size();
  create.pInitialData = blob.data();
  return device.vk().vkCreatePipelineCache(device.handle(), &create, nullptr, &cache);
}

}  // namespace

Result<PipelineCache> PipelineCache::create(const Device& device, const std::filesystem::path& path) {
  PipelineCache made;
  made.device_ = &device;
  made.path_ = path;
  CacheContent content;
  std::error_code ignored;
  if (!path.empty() && std::filesystem::exists(path, ignored)) {
    Result<CacheContent> loaded = load(device, path);
    if (loaded) {
      content = std::move(*loaded);
      std::vector<uint32_t> specialized(content.specialized_bytes / sizeof(uint32_t));
      std::memcpy(specialized.data(), content.bytes.data(), specialized.size() * sizeof(uint32_t));
      device.specializer().remember(specialized);
    } else {
      made.broken_files_ = 1;
      made.refusal_ = loaded.error();
    }
  }
  VkPipelineCache cache = VK_NULL_HANDLE;
  VkResult result = create_cache(device, content.blob(), cache);
  if (result != VK_SUCCESS && !content.blob().empty()) {
    made.broken_files_ = 1;
    made.refusal_ = "pipeline cache " + path.string() + " is ignored: the driver answered " + result_text(result);
    content = {};
    result = create_cache(device, {}, cache);
  }
  if (result != VK_SUCCESS) return fail("the pipeline cache could not be created: ", result_name(result));
  made.loaded_bytes_ = content.bytes.size();
  made.loaded_specialized_bytes_ = content.specialized_bytes;
  made.cache_ = OwnedPipelineCache(device, cache);
  device.name_object(VK_OBJECT_TYPE_PIPELINE_CACHE, cache, "weft");
  return made;
}

Result<void> PipelineCache::save() const {
  if (path_.empty() || !cache_) return {};
  const Functions& fn = device_->vk();
  size_t bytes = 0;
  VkResult result = fn.vkGetPipelineCacheData(device_->handle(), cache_.get(), &bytes, nullptr);
  // Neither grew: both are only added to.
  const size_t specialized_bytes = device_->specializer().remembered_words() * sizeof(uint32_t);
  if (result == VK_SUCCESS && specialized_bytes == loaded_specialized_bytes_ && specialized_bytes + bytes == loaded_bytes_) return {};
  std::vector<std::byte> blob(bytes);
  if (result == VK_SUCCESS) result = fn.vkGetPipelineCacheData(device_->handle(), cache_.get(), &bytes, blob.data());
  if (result != VK_SUCCESS) return fail("the pipeline cache could not be read from the driver: ", result_name(result));
  blob.resize(bytes);
  const std::vector<uint32_t> remembered = device_->specializer().remembered();
  const auto specialized = std::as_bytes(std::span(remembered));
  blob.insert(blob.begin(), specialized.begin(), specialized.end());
  if (sizeof(CacheHeader) + blob.size() > kMaxCacheBytes) {
    return fail("pipeline cache ", path_.string(), " would have ", blob.size(), " bytes, above ", kMaxCacheBytes);
  }

  const CacheHeader header = header_for(*device_, blob, static_cast<uint32_t>(specialized.size()));
  std::error_code problem;
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), problem);
  const auto front = std::as_bytes(std::span(&header, 1));
  blob.insert(blob.begin(), front.begin(), front.end());
  if (Result<void> written = write_file(path_, blob, Link::replace); !written) return fail("pipeline cache: ", written.why());
  return {};
}

Result<OwnedShaderModule> create_shader_module(const Device& device, std::string_view name,
                                               std::span<const uint32_t> spirv) {
  auto create = typed<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  create.codeSize = spirv.size_bytes();
  create.pCode = spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  const VkResult result = device.vk().vkCreateShaderModule(device.handle(), &create, nullptr, &module);
  if (result != VK_SUCCESS) return fail("shader ", name, " could not be loaded: ", result_name(result));
  device.name_object(VK_OBJECT_TYPE_SHADER_MODULE, module, name);
  return OwnedShaderModule(device, module);
}

Result<ComputePipeline> ComputePipeline::create(const Device& device, const PipelineCache* cache, std::string_view name,
                                                std::span<const uint32_t> spirv,
                                                std::span<const SpecializationConstant> constants,
                                                VkPipelineLayout layout) {
  // Drivers may crash on what is not SPIR-V, and on workgroups they cannot hold; a sentence is better.
  Result<Reflection> reflection = reflect(spirv);
  if (!reflection) return fail("shader ", name, ": ", reflection.why());
  uint64_t invocations = 1;
  for (int axis = 0; axis < 3; ++axis) {
    uint32_t size = reflection->local_size[axis];
    for (const SpecializationConstant& constant : constants) {
      if (reflection->local_size_id[axis] == constant.id) size = constant.value;
    }
    invocations *= size;  // at most limit × 2^32: checked after every axis
    if (invocations == 0 || invocations > device.limits().max_workgroup_invocations) {
      return fail("shader ", name, " has a workgroup of ", invocations, " invocations up to axis ", axis,
                  ", not between 1 and ", device.limits().max_workgroup_invocations,
                  ", the maxComputeWorkGroupInvocations of ", device.name());
    }
  }
  Result<OwnedShaderModule> module = create_shader_module(device, name, spirv);
  if (!module) return module.take_error();

  std::vector<VkSpecializationMapEntry> entries;
  for (size_t i = 0; i < constants.size(); ++i) {
    const size_t offset = i * sizeof(SpecializationConstant) + offsetof(SpecializationConstant, value);
    entries.push_back({constants[i].id, static_cast<uint32_t>(offset), sizeof(uint32_t)});
  }
  VkSpecializationInfo specialization{};
  specialization.mapEntryCount = static_cast<uint32_t>(entries.size());
  specialization.pMapEntries = entries.data();
  specialization.dataSize = constants.size_bytes();
  specialization.pData = constants.data();
  auto create = typed<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  create.stage = typed<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = module->get();
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = &specialization;
  create.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result = device.vk().vkCreateComputePipelines(
      device.handle(), cache != nullptr ? cache->handle() : VK_NULL_HANDLE, 1, &create, nullptr, &pipeline);
  if (result != VK_SUCCESS) return fail("pipeline ", name, " could not be compiled: ", result_name(result));
  device.name_object(VK_OBJECT_TYPE_PIPELINE, pipeline, name);
  ComputePipeline made;
  made.pipeline_ = OwnedPipeline(device, pipeline);
  return made;
}

}  // namespace weft::compute
