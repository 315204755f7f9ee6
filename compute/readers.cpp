// Tables of the stages, accesses and usages by which a buffer is read. See readers.h.
#include "compute/readers.h"

namespace weft::compute {
namespace {

/// A feature by its name in Vulkan; none: it takes no feature.
struct Need {
  bool Features::*feature = nullptr;
  const char* name = nullptr;
};
constexpr Need kGeometry{&Features::geometry_shader, "geometryShader"};
constexpr Need kTessellation{&Features::tessellation_shader, "tessellationShader"};
constexpr Need kTask{&Features::task_shader, "taskShader"};
constexpr Need kMesh{&Features::mesh_shader, "meshShader"};
constexpr Need kRays{&Features::ray_tracing_pipeline, "rayTracingPipeline"};
constexpr Need kStructures{&Features::acceleration_structure, "accelerationStructure"};
constexpr Need kAddress{&Features::buffer_device_address, "bufferDeviceAddress"};

struct Bit {
  VkFlags64 bits = 0;
  const char* name = "";
};
struct Stage : Bit {
  VkAccessFlags2 reads = 0;
  VkQueueFlags queue = 0;   // what it takes
  Need need = {};
};
struct Usage : Bit {
  Need need = {};
};

#define WEFT_BIT(name) \
  { name, #name }

constexpr Bit kAccesses[] = {
    WEFT_BIT(VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT), WEFT_BIT(VK_ACCESS_2_INDEX_READ_BIT),
    WEFT_BIT(VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT), WEFT_BIT(VK_ACCESS_2_UNIFORM_READ_BIT),
    WEFT_BIT(VK_ACCESS_2_SHADER_READ_BIT),           WEFT_BIT(VK_ACCESS_2_SHADER_SAMPLED_READ_BIT),
    WEFT_BIT(VK_ACCESS_2_SHADER_STORAGE_READ_BIT),   WEFT_BIT(VK_ACCESS_2_TRANSFER_READ_BIT),
    WEFT_BIT(VK_ACCESS_2_MEMORY_READ_BIT),
};

// Vulkan 1.3, table "Supported access types". MEMORY_READ, which all stages have, is left out.
constexpr VkAccessFlags2 kShader = VK_ACCESS_2_UNIFORM_READ_BIT | VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT |
                                   VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
constexpr VkAccessFlags2 kInput = VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT;
constexpr VkAccessFlags2 kGraphics = VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | kInput | kShader;
constexpr VkQueueFlags kDraws = VK_QUEUE_GRAPHICS_BIT;

constexpr Stage kStages[] = {
    {WEFT_BIT(VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT), VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT), VK_ACCESS_2_INDEX_READ_BIT, kDraws},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT), VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT, kDraws},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT), kInput, kDraws},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT), kShader, kDraws},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_TESSELLATION_CONTROL_SHADER_BIT), kShader, kDraws, kTessellation},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_TESSELLATION_EVALUATION_SHADER_BIT), kShader, kDraws, kTessellation},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_GEOMETRY_SHADER_BIT), kShader, kDraws, kGeometry},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_TASK_SHADER_BIT_EXT), kShader, kDraws, kTask},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_MESH_SHADER_BIT_EXT), kShader, kDraws, kMesh},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT), kShader, kDraws},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT), kShader, kDraws},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT), kGraphics, kDraws},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT), kShader},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR), kShader, 0, kRays},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR), VK_ACCESS_2_SHADER_READ_BIT, 0, kStructures},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_COPY_BIT), VK_ACCESS_2_TRANSFER_READ_BIT},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT), VK_ACCESS_2_TRANSFER_READ_BIT},
    {WEFT_BIT(VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT), kGraphics | VK_ACCESS_2_TRANSFER_READ_BIT},
};

constexpr Usage kUsages[] = {
    {WEFT_BIT(VK_BUFFER_USAGE_TRANSFER_SRC_BIT)},
    {WEFT_BIT(VK_BUFFER_USAGE_TRANSFER_DST_BIT)},
    {WEFT_BIT(VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT)},
    {WEFT_BIT(VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT)},
    {WEFT_BIT(VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT)},
    {WEFT_BIT(VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)},
    {WEFT_BIT(VK_BUFFER_USAGE_VERTEX_BUFFER_BIT)},
    {WEFT_BIT(VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT), kAddress},
    {WEFT_BIT(VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR), kStructures},
};

#undef WEFT_BIT

/// "VK_ACCESS_2_INDEX_READ_BIT and VK_ACCESS_2_SHADER_READ_BIT": those of `bits` that the table has.
template <class Table>
std::string names(const Table& table, VkFlags64 bits) {
  std::string all;
  for (const Bit& bit : table)
    if (bits & bit.bits) all += (all.empty() ? "" : " and ") + std::string(bit.name);
  return all;
}

/// What is left of `bits` without those that the table has: "0x8000".
template <class Table>
std::string strangers(const Table& table, VkFlags64 bits) {
  for (const Bit& bit : table) bits &= ~bit.bits;
  if (bits == 0) return {};
  std::string digits;
  for (; bits != 0; bits >>= 4) digits.insert(digits.begin(), "0123456789abcdef"[bits & 15]);
  return "0x" + digits;
}

Result<void> check_need(const Device& device, const char* what, const char* name, const Need& need) {
  if (need.feature == nullptr || device.features().*need.feature) return {};
  return fail(what, ": ", name, " takes the feature ", need.name, ", which is not enabled on ", device.name());
}

}  // namespace

Result<void> check_readers(const Device& device, const Readers& readers) {
  if (readers.stages == 0) return fail("readers: no stage is named");
  if (readers.accesses == 0) return fail("readers: no access is named");
  if (const std::string unknown = strangers(kStages, readers.stages); !unknown.empty())
    return fail("readers: the stages ", unknown, " are none in which a buffer is read");
  if (const std::string unknown = strangers(kAccesses, readers.accesses); !unknown.empty())
    return fail("readers: the accesses ", unknown, " are none by which a buffer is read");
  VkAccessFlags2 possible = VK_ACCESS_2_MEMORY_READ_BIT;
  for (const Stage& stage : kStages) {
    if ((readers.stages & stage.bits) == 0) continue;
    possible |= stage.reads;
    if ((device.queue_flags() & stage.queue) != stage.queue)
      return fail("readers: ", stage.name, " takes a queue that draws; queue family ", device.queue_family(), " of ", device.name(),
                  " does not");
    if (auto good = check_need(device, "readers", stage.name, stage.need); !good) return good;
    if ((readers.accesses & (stage.reads | VK_ACCESS_2_MEMORY_READ_BIT)) == 0)
      return fail("readers: ", stage.name, " has none of the accesses ", names(kAccesses, readers.accesses));
  }
  if (const VkAccessFlags2 idle = readers.accesses & ~possible; idle != 0)
    return fail("readers: none of the stages ", names(kStages, readers.stages), " has the access ", names(kAccesses, idle));
  return {};
}

Result<void> check_usage(const Device& device, VkBufferUsageFlags usage) {
  if (const std::string unknown = strangers(kUsages, usage); !unknown.empty())
    return fail("vertex_usage: the bits ", unknown, " are none for which a buffer of vertices is created");
  for (const Usage& one : kUsages)
    if (usage & one.bits)
      if (auto good = check_need(device, "vertex_usage", one.name, one.need); !good) return good;
  return {};
}

}  // namespace weft::compute
