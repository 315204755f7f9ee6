// The solver: a plan's pipelines and buffers, and the dispatches that a frame records. Knows nothing about time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compute/buffer.h"
#include "compute/recorder.h"
#include "compute/shared_passes.h"
#include "engine/effects/air/air.h"
#include "engine/fabric.h"
#include "engine/scene.h"
#include "engine/solve/frame_program.h"
#include "engine/solve/plan.h"

namespace weft {

struct SolverOptions {
  bool gather_storage = false;
  std::uint32_t workgroup = 0;   // threads; 0 chooses for the device
  Vec3 origin = {};              // m: of the particles' positions, in world space
  VkBufferUsageFlags vertex_usage = 0;   // of the buffers that a host draws from, besides Weft's own
  std::optional<bool> idle_costs = {};   // threads without work go through all of a shader; as the device has it
};

/// Bytes of a buffer that a frame overwrites before all else.
struct Edit {
  const Buffer* row = nullptr;
  std::uint64_t at = 0;            // multiples of 4
  std::vector<std::byte> bytes;
  std::uint64_t from = 0, copied = 0;   // instead: so many bytes of the same buffer, from there
};

template <class T>
Edit edit_of(const Buffer& row, std::uint64_t at, const T& value) {
  const auto bytes = std::as_bytes(std::span(&value, 1));
  return {&row, at, {bytes.begin(), bytes.end()}};
}

/// What a frame copies from a buffer of the host's before all else.
struct HostCopy {
  const Buffer* row = nullptr;     // to
  VkDeviceSize to = 0;             // bytes
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize from = 0, bytes = 0;
};

/// A frame's input from the host. The spans need only live during record_input.
struct FrameInput {
  std::uint32_t substeps = 0;
  std::uint64_t first_substep = 0;            // of all since the simulation's start
  Vec3 gravity;
  float haste = 0;                            // the farthest that an anchor goes in a substep, or lately has, over the length of links
  bool is_driven = false;                     // something may drive cloth along among contacts (Motion::level_kept)
  std::optional<MovingAir> air;               // where the scene has any
  bool anchors_move = false;
  bool kinematics_rest = false;               // no kinematic particle can move, or have been driven through cloth, since a frame that is done
  bool few_contacts = false;                  // Crowd::few; the same bits either way
  bool no_contacts = false;                   // none were known, and they are few: not Crowd::met; the same bits either way
  bool seldom_detections = false;             // Crowd::seldom; the same bits either way
  bool is_still = false;                      // no detection is expected; who runs the frame looks whether one was needed, and repeats it
  bool has_no_candidates = false;             // and a still frame has none of the contacts' passes
  std::span<const gpu::Anchor> anchors;       // when they move
  std::span<const gpu::Collider> colliders;   // by shape, as the buffer has them
  std::span<const gpu::BodySize> body_sizes;  // of these, where the frame begins
  std::span<const gpu::Joint> joints;         // of all skins
  std::span<const gpu::vec2> morph_weights;   // of all skins
  std::span<const gpu::uint> skin_sources;    // of all skinned meshes
  std::span<const HostCopy> host_copies;
  std::span<const gpu::MotionLimits> motion_limits;   // of all cloths
  std::span<const gpu::Grab> grabs;
  std::span<const gpu::FrameChange> frame_changes;    // of all cloths
  std::span<const float> gas_amounts;         // of all cloths
  std::span<const Edit> edits;
};

class Solver {
 public:
  static Result<Solver> create(const compute::Device& device, const compute::PipelineCache& cache, const Scene& scene,
                               const CookedFabric& fabric, const SolverOptions& options);

  /// One dispatch of a frame.
  struct Step {
    std::uint32_t pass;    // into plan().passes
    std::uint32_t parity;  // which of the two iterates is `predicted`
    gpu::Push push;
  };
  struct Sets {
    compute::DescriptorSet sets[2][2];     // by parity: storage, texels
  };
  /// What frames that were recorded before the capacity grew still use.
  struct Outgrown {
    compute::Arena buffers;
    std::vector<Sets> sets;
    VkBuffer candidates = VK_NULL_HANDLE;  // of `buffers`: those found so far
    VkDeviceSize bytes = 0;
  };
  /// Sets the capacity for candidates. The new buffers are empty: the candidates found so far are to be copied into them, or the next
  /// substep must detect. Errors: no memory; a device limit; the capacity then stays as it was.
  Result<Outgrown> grow(std::uint32_t candidates);

  /// Whether lists of torn cloth fit into the buffers and the pipelines that were made for it when it was whole; else why not.
  Result<void> fits(const Cooked& subject) const;
  /// From the next frame on dispatches are as long as its lists, which edits bring.
  void follow(const Cooked& subject);

  /// Lists a frame's dispatches and advances the parity of the iterates: call once a frame, then record all of it.
  std::span<const Step> frame(const FrameInput& input);

  /// The dispatches of Stage::frame_end alone: the surface of the current pose.
  std::span<const Step> surface();

  /// Records edits alone; visible to what uses barriers against copies.
  void record_edits(compute::Recorder& recorder, std::span<const Edit> edits) const;
  /// Records the copies of a frame's input into the GPU's buffers; visible to the steps after it.
  void record_input(compute::Recorder& recorder, const FrameInput& input);
  void record_step(compute::Recorder& recorder, const Step& step) const;

  const Plan& plan() const { return plan_; }
  /// Dispatches of a pass where it is listed once.
  std::size_t rounds(std::size_t pass) const { return runs_[pass].ranges.size(); }
  /// How often an iteration lists it, with the neighbours that have as many sweeps, where anchors have so much haste.
  std::uint32_t sweeps(std::size_t pass, float haste) const;
  /// Must be a buffer of the plan. `predicted` and `next_iterate` by name, not by role.
  const compute::Buffer& buffer(const Buffer& row) const;
  /// What the passes use of it; its memory is rounded up.
  std::uint64_t used_bytes(const Buffer& row) const;
  bool has(const Buffer& row) const { return plan_.has(row); }
  /// All of them with their sizes.
  std::vector<const compute::Buffer*> buffers() const;
  const gpu::ContactSettings& contact_settings() const { return contacts_; }
  /// Whether one workgroup can do a detection (FrameInput::seldom_detections).
  bool can_detect_alone() const;
  /// Which of the two iterates the next frame begins with; restored before a frame is repeated.
  std::uint32_t parity() const { return parity_; }
  void set_parity(std::uint32_t parity) { parity_ = parity; }
  /// Substeps modulo 3: where in gpu::Acceleration the next one finds its predecessors.
  std::uint32_t phase() const { return phase_; }
  void set_phase(std::uint32_t phase) { phase_ = phase; }

 private:
  // A buffer of the plan: how many bytes of it are used, and where it is.
  struct Place {
    std::uint64_t bytes = 0;
    std::size_t index = 0;   // in its arena
  };
  struct SliceRange {
    std::size_t at = 0, bytes = 0;
  };
  // A pass: its dispatches where it is listed once, and what they run with.
  struct Run {
    std::vector<Range> ranges;
    std::uint32_t every = 1;               // substeps
    std::uint32_t groups = 0;              // of workgroups; 0: as many as a range needs
    compute::Touches touches[2];           // by parity
    std::shared_ptr<const compute::CompiledPass> compiled;
  };
  Result<compute::Arena> create_arena(bool grows) const;
  Result<void> create_buffers(const Cooked& subject);
  Result<void> create_runs(const Cooked& subject, const compute::PipelineCache& cache);
  Result<compute::CompiledPass> compile(const PlannedPass& planned, const compute::PipelineCache& cache) const;
  Result<std::vector<Sets>> write_sets() const;
  void list_frame(const FrameInput& input);
  bool ends_with_contacts(const FrameInput& input) const;
  bool is_recorded(Crowd crowd, const FrameInput& input) const;
  void list(Stage stage, const FrameInput& input, const gpu::Push& push, std::uint64_t substep);
  void list(std::uint32_t pass, Stage stage, const FrameInput& input, const gpu::Push& push, std::uint64_t substep, std::uint32_t sweep);
  /// From the next recorded frame on. `value` is the struct of the slice.
  template <class T>
  void set_uniforms(std::string_view slice, const T& value) {
    set_uniform_bytes(slice, std::as_bytes(std::span(&value, 1)));
  }
  void record_bytes(compute::Recorder& recorder, const compute::Buffer& to, std::span<const std::byte> bytes, std::uint64_t first = 0) const;
  void set_uniform_bytes(std::string_view slice, std::span<const std::byte> bytes);

  const compute::Device* device_ = nullptr;
  Plan plan_;
  FrameShape shape_;
  std::vector<Place> places_;      // of plan_.buffers
  compute::Arena arena_, growing_arena_;
  Needs needs_;
  std::vector<Run> runs_;          // of plan_.passes
  std::vector<Sets> sets_;
  std::vector<Step> steps_;
  gpu::ContactSettings contacts_{};
  gpu::Motion motion_{};
  std::vector<std::byte> uniforms_;    // the uniform buffer as the next frame tells it
  std::vector<SliceRange> slices_; // of plan_.slices, in it
  VkBufferUsageFlags vertex_usage_ = 0;
  std::uint32_t workgroup_ = 0, parity_ = 0, phase_ = 0;
  bool has_seldom_ = false;   // passes for frames in which detections are seldom, and calm ones
  double rho_ = 0;
};

}  // namespace weft
