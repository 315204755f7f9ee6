// Barriers, labels and timestamps around passes. See recorder.h.
#include "compute/recorder.h"

#include <algorithm>
#include <cassert>

#include "compute/synchronization.h"

namespace weft::compute {
namespace {

constexpr uint32_t kNoSlot = UINT32_MAX;

struct Scope {
  VkPipelineStageFlags2 stages = 0;
  VkAccessFlags2 writes = 0;
  VkAccessFlags2 all = 0;  // reads and writes
};

constexpr Scope kCompute = {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                            VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                                VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT};
constexpr Scope kIndirect = {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, 0, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};
constexpr Scope kTransfer = {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                             VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr Scope kHost = {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_WRITE_BIT,
                         VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_HOST_WRITE_BIT};
constexpr Scope kVertex = {VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT, 0,
                           VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT |
                               VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};

bool has(Use uses, Use one) { return (static_cast<uint32_t>(uses) & static_cast<uint32_t>(one)) != 0; }

Scope operator|(Scope a, Scope b) { return {a.stages | b.stages, a.writes | b.writes, a.all | b.all}; }

/// A queue that cannot draw knows no vertex stages.
Scope scope_of(const Users& users, VkQueueFlags queue) {
  const Use uses = users.uses;
  Scope scope{users.readers.stages, 0, users.readers.accesses};
  if (has(uses, Use::compute)) scope = scope | kCompute;
  if (has(uses, Use::indirect)) scope = scope | kIndirect;
  if (has(uses, Use::transfer)) scope = scope | kTransfer;
  if (has(uses, Use::host)) scope = scope | kHost;
  if (has(uses, Use::vertex) && (queue & VK_QUEUE_GRAPHICS_BIT) != 0) scope = scope | kVertex;
  return scope;
}

void record_barrier(const Device& device, VkCommandBuffer commands, Scope from, Scope to) {
  auto barrier = typed<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  barrier.srcStageMask = from.stages;
  barrier.srcAccessMask = from.writes;
  barrier.dstStageMask = to.stages;
  // Without a write there is nothing to make visible: the barrier then only orders execution.
  barrier.dstAccessMask = from.writes != 0 ? to.all : 0;
  record_barrier(device, commands, barrier);
}

}  // namespace

// A command buffer of a host that has a part of a frame cannot be taken back: recording must not run out of memory.
HazardTracker::HazardTracker() {
  constexpr std::size_t kNumbers = 512;   // far more than there are buffers
  for (IndexSet* set : {&read_, &written_, &argument_read_, &unseen_by_indirect_}) set->reserve(kNumbers);
}

bool HazardTracker::needs_barrier(const Touches& pass) const {
  return pass.reads.intersects(written_) || pass.writes.intersects(written_) || pass.writes.intersects(read_) ||
         pass.writes.intersects(argument_read_) || pass.arguments.intersects(unseen_by_indirect_);
}

void HazardTracker::note(const Touches& pass) {
  read_.insert(pass.reads);
  written_.insert(pass.writes);
  argument_read_.insert(pass.arguments);
  unseen_by_indirect_.insert(pass.writes);
}

void HazardTracker::barrier(bool to_indirect) {
  read_.clear();
  written_.clear();
  argument_read_.clear();
  if (to_indirect) unseen_by_indirect_.clear();
}

Result<Timestamps> Timestamps::create(const Device& device, std::string_view name, uint32_t passes) {
  Timestamps made;
  made.device_ = &device;
  if (device.timestamp_period_ns() == 0 || passes == 0) return made;
  auto create = typed<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  create.queryType = VK_QUERY_TYPE_TIMESTAMP;
  create.queryCount = 2 * passes;
  VkQueryPool pool = VK_NULL_HANDLE;
  const VkResult result = device.vk().vkCreateQueryPool(device.handle(), &create, nullptr, &pool);
  if (result != VK_SUCCESS) {
    return fail("timestamps ", name, " for ", passes, " passes could not be created: ", result_name(result));
  }
  device.name_object(VK_OBJECT_TYPE_QUERY_POOL, pool, name);
  made.pool_ = OwnedQueryPool(device, pool);
  made.capacity_ = passes;
  made.slots_.reserve(passes);
  return made;
}

void Timestamps::rewind(VkCommandBuffer commands) {
  slots_.clear();
  dropped_ = 0;
  if (supported()) device_->vk().vkCmdResetQueryPool(commands, pool_.get(), 0, 2 * capacity_);
}

uint32_t Timestamps::begin(VkCommandBuffer commands, std::string_view name) {
  if (!supported()) return kNoSlot;
  if (slots_.size() == capacity_) {
    ++dropped_;
    return kNoSlot;
  }
  // A few dozen names at most, so a search from the front is as good as any map.
  const auto known = std::find(names_.begin(), names_.end(), name);
  const uint32_t slot = static_cast<uint32_t>(slots_.size());
  slots_.push_back(static_cast<uint32_t>(known - names_.begin()));
  if (known == names_.end()) names_.emplace_back(name);
  // Behind all commands, at both ends: the pair then encloses the pass alone, not the tail of the pass before it.
  device_->vk().vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, pool_.get(), 2 * slot);
  return slot;
}

void Timestamps::end(VkCommandBuffer commands, uint32_t slot) {
  if (slot == kNoSlot) return;
  device_->vk().vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, pool_.get(), 2 * slot + 1);
}

Result<std::vector<PassTime>> Timestamps::read() const {
  std::vector<PassTime> times;
  if (!supported() || slots_.empty()) return times;
  std::vector<uint64_t> ticks(2 * slots_.size());
  const VkResult result = device_->heard(device_->vk().vkGetQueryPoolResults(
      device_->handle(), pool_.get(), 0, static_cast<uint32_t>(ticks.size()), ticks.size() * sizeof(uint64_t),
      ticks.data(), sizeof(uint64_t), VK_QUERY_RESULT_64_BIT));
  if (result == VK_NOT_READY) {
    return fail("the timestamps of ", slots_.size(), " passes are not ready: their submit has not finished");
  }
  if (result != VK_SUCCESS) return fail("timestamps could not be read: ", result_name(result));
  const uint32_t bits = device_->limits().timestamp_bits;
  const uint64_t mask = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
  const double ms_per_tick = device_->timestamp_period_ns() * 1e-6;
  // Differences modulo the valid bits survive a counter that wraps around once.
  const auto since_start = [&](uint64_t tick) { return static_cast<double>((tick - ticks[0]) & mask) * ms_per_tick; };
  for (size_t i = 0; i < slots_.size(); ++i) {
    times.push_back({slots_[i], since_start(ticks[2 * i]), since_start(ticks[2 * i + 1])});
  }
  return times;
}

Recorder::Recorder(const Device& device, VkCommandBuffer commands, Timestamps* timestamps)
    : device_(&device), commands_(commands), timestamps_(timestamps) {}

Recorder::~Recorder() { finish(); }

void Recorder::begin_pass(const char* name, const Touches& touches) {
  finish();
  const Functions& fn = device_->vk();
  if (hazards_.needs_barrier(touches)) {
    const bool reads_arguments = !touches.arguments.empty();
    const Scope from = hazards_.waits_for_indirect() ? kCompute | kIndirect : kCompute;
    const Scope to = reads_arguments ? kCompute | kIndirect : kCompute;
    record_barrier(*device_, commands_, from, to);
    hazards_.barrier(reads_arguments);
    ++barriers_;
  }
  hazards_.note(touches);
  if (fn.vkCmdBeginDebugUtilsLabelEXT != nullptr) {
    auto label = typed<VkDebugUtilsLabelEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT);
    label.pLabelName = name;
    fn.vkCmdBeginDebugUtilsLabelEXT(commands_, &label);
  }
  slot_ = timestamps_ != nullptr ? timestamps_->begin(commands_, name) : kNoSlot;
  in_pass_ = true;
}

void Recorder::finish() {
  if (!in_pass_) return;
  if (timestamps_ != nullptr) timestamps_->end(commands_, slot_);
  if (device_->vk().vkCmdEndDebugUtilsLabelEXT != nullptr) device_->vk().vkCmdEndDebugUtilsLabelEXT(commands_);
  in_pass_ = false;
}

void Recorder::bind(VkPipeline pipeline, VkPipelineLayout layout, std::span<const VkDescriptorSet> sets) {
  const Functions& fn = device_->vk();
  fn.vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
  if (sets.empty()) return;
  fn.vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, static_cast<uint32_t>(sets.size()),
                             sets.data(), 0, nullptr);
}

void Recorder::push(VkPipelineLayout layout, std::span<const std::byte> bytes) {
  assert(bytes.size() <= device_->limits().max_push_constant_bytes && bytes.size() % 4 == 0);
  device_->vk().vkCmdPushConstants(commands_, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                   static_cast<uint32_t>(bytes.size()), bytes.data());
}

void Recorder::dispatch(uint32_t x, uint32_t y, uint32_t z) {
  assert(in_pass_ && "a dispatch outside of a pass would stand outside of the barriers");
  device_->vk().vkCmdDispatch(commands_, x, y, z);
  ++dispatches_;
}

void Recorder::dispatch_indirect(VkBuffer arguments, VkDeviceSize offset) {
  assert(in_pass_ && "a dispatch outside of a pass would stand outside of the barriers");
  device_->vk().vkCmdDispatchIndirect(commands_, arguments, offset);
  ++dispatches_;
}

void Recorder::barrier(Users from, Users to) {
  finish();
  Scope before = scope_of(from, device_->queue_flags());
  const Scope after = scope_of(to, device_->queue_flags());
  const bool between_shaders = has(from.uses, Use::compute) && has(to.uses, Use::compute);
  if (between_shaders && hazards_.waits_for_indirect()) before = before | kIndirect;
  if (before.stages == 0 || after.stages == 0) return;
  record_barrier(*device_, commands_, before, after);
  if (between_shaders) hazards_.barrier(has(to.uses, Use::indirect));
  ++barriers_;
}

void Recorder::tell_host(VkEvent event) {
  finish();
  device_->vk().vkCmdSetEvent(commands_, event, VK_PIPELINE_STAGE_TRANSFER_BIT);
}

}  // namespace weft::compute
