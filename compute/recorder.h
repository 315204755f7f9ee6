// Recording passes: barriers where passes touch the same buffer, a label and a timestamp pair around each.
//
// A pass says which buffers it reads and which it writes, by numbers of the caller's choice. Between two passes stands a
// barrier exactly when one is needed:
//
//     (reads & written) | (writes & (written | read))
//
// where `read` and `written` are what was touched since the last barrier. The barrier is one global memory barrier:
// with a handful of buffers that all live in one arena, barriers per buffer only cost the driver time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compute/index_set.h"
#include "compute/owned.h"
#include "compute/readers.h"

namespace weft::compute {

/// The buffers that a pass touches. `arguments`: whose dispatch arguments it reads.
struct Touches {
  IndexSet reads, writes, arguments;
};

/// Remembers what was touched since the last barrier. Pure: calls no Vulkan.
///
/// Reading dispatch arguments (`indirect`) happens in another pipeline stage than shaders, so a barrier between shaders
/// does not reach it: what was written and not yet shown to that stage is kept apart.
class HazardTracker {
 public:
  HazardTracker();
  bool needs_barrier(const Touches& pass) const;
  /// Some argument reads are pending, so a barrier must also wait for that stage.
  bool waits_for_indirect() const { return !argument_read_.empty(); }
  /// Records what a pass touches; call barrier() first if needs_barrier() said so.
  void note(const Touches& pass);
  /// A barrier from and to shaders was recorded; `to_indirect`: also to the stage that reads arguments.
  void barrier(bool to_indirect = false);

 private:
  IndexSet read_, written_, argument_read_;
  IndexSet unseen_by_indirect_;
};

/// Time of one pass on the GPU, in milliseconds after the first timestamp of the frame.
struct PassTime {
  uint32_t name = 0;  ///< index into Timestamps::names()
  double begin_ms = 0;
  double end_ms = 0;
};

/// A pair of timestamps per pass. On a queue without timestamps supported() is false and nothing is recorded: the caller
/// times on the CPU and says so.
///
/// Recording: rewind() into the command buffer, then hand it to a Recorder of the same. It may be submitted once; read() when that is done.
class Timestamps {
 public:
  /// Up to `passes` passes per recording; more are counted in dropped().
  static Result<Timestamps> create(const Device& device, std::string_view name, uint32_t passes);
  Timestamps() = default;

  bool supported() const { return static_cast<bool>(pool_); }
  /// Forgets what was recorded, and records that the device does: before recording anew. The GPU must be done with the last submit.
  void rewind(VkCommandBuffer commands);
  /// In order of recording. Empty when unsupported. An error when the submit has not finished.
  Result<std::vector<PassTime>> read() const;
  const std::vector<std::string>& names() const { return names_; }
  uint32_t dropped() const { return dropped_; }

 private:
  friend class Recorder;
  uint32_t begin(VkCommandBuffer commands, std::string_view name);
  void end(VkCommandBuffer commands, uint32_t slot);

  const Device* device_ = nullptr;
  OwnedQueryPool pool_;
  uint32_t capacity_ = 0;
  uint32_t dropped_ = 0;
  std::vector<std::string> names_;
  std::vector<uint32_t> slots_;  // slot -> name
};

/// Who touches memory, for barriers beyond those between passes.
enum class Use : uint32_t {
  compute = 1,   ///< storage and texel buffers in compute shaders
  indirect = 2,  ///< dispatch or draw arguments
  transfer = 4,  ///< copies and fills
  host = 8,      ///< mapped memory
  vertex = 16,   ///< vertex and index buffers, and buffers read in vertex shaders
  all = 31,
};
constexpr Use operator|(Use a, Use b) { return static_cast<Use>(static_cast<uint32_t>(a) | static_cast<uint32_t>(b)); }

/// Uses, and the readers of a host besides.
struct Users {
  Users(Use uses, Readers readers = {}) : uses(uses), readers(readers) {}
  Use uses;
  Readers readers;
};

/// Records into a command buffer that is in the recording state; owns nothing. Allocates only when a pass name is new to
/// its Timestamps.
///
///     Recorder recorder(device, commands, &timestamps);
///     recorder.barrier(Use::transfer, Use::compute);
///     recorder.begin_pass("predict", touches);
///     recorder.bind(pipeline, layout, sets);
///     recorder.dispatch(groups);
///     recorder.finish();
///
/// A recording starts with no memory: what earlier submits wrote needs an explicit barrier.
class Recorder {
 public:
  Recorder(const Device& device, VkCommandBuffer commands, Timestamps* timestamps = nullptr);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Ends the pass before it, and puts a barrier between if there must be one. Dispatches within one pass must not
  /// depend on each other. `name` ends in a zero byte.
  void begin_pass(const char* name, const Touches& touches);
  void bind(VkPipeline pipeline, VkPipelineLayout layout, std::span<const VkDescriptorSet> sets);
  void push(VkPipelineLayout layout, std::span<const std::byte> bytes);
  void dispatch(uint32_t x, uint32_t y = 1, uint32_t z = 1);
  void dispatch_indirect(VkBuffer arguments, VkDeviceSize offset = 0);
  /// Ends the last pass.
  void finish();

  /// Everything `from` wrote is seen by `to`, and `to` waits until `from` has read. Ends the current pass.
  void barrier(Users from, Users to);

  /// Sets the event when all copies before it are done and the host can read what they wrote, which a barrier behind them, from transfer to
  /// transfer and host, must have said. Ends the current pass.
  void tell_host(VkEvent event);

  VkCommandBuffer commands() const { return commands_; }
  uint32_t barriers() const { return barriers_; }
  uint32_t dispatches() const { return dispatches_; }

 private:
  const Device* device_;
  VkCommandBuffer commands_;
  Timestamps* timestamps_;
  HazardTracker hazards_;
  bool in_pass_ = false;
  uint32_t slot_ = 0;
  uint32_t barriers_ = 0;
  uint32_t dispatches_ = 0;
};

}  // namespace weft::compute
