// The solver: a plan's pipelines and buffers, and the loop over stages that a frame records. Knows nothing about time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/buffer.h"
#include "compute/descriptors.h"
#include "compute/pipeline.h"
#include "compute/recorder.h"
#include "engine/fabric.h"
#include "engine/passes.h"
#include "engine/scene.h"

namespace weft {

struct SolverOptions {
  bool gather_storage = false;
  std::uint32_t workgroup = 0;   // threads; 0 chooses for the device
};

/// What a frame is told by the host. The spans need only live during record.
struct FrameInput {
  std::uint32_t substeps = 0;
  Vec3 gravity;
  bool anchors_move = false;
  std::span<const gpu::Anchor> anchors;       // when they move
  std::span<const gpu::Collider> colliders;   // by shape, as the buffer has them
};

class Solver {
 public:
  static Result<Solver> create(const compute::Device& device, const compute::PipelineCache& cache, const Scene& scene, const CookedFabric& fabric,
                               const SolverOptions& options);

  /// One dispatch of a frame.
  struct Step {
    std::uint32_t pass;    // into plan().passes
    std::uint32_t parity;  // which of the two iterates is `predicted`
    gpu::Push push;
  };
  /// Room for this many candidates from now on; those found so far are lost, so that the next substep must detect. The GPU must be done
  /// with this solver. Errors: no memory; a device limit; the room then stays as it was.
  Result<void> grow(std::uint32_t candidates);

  /// Lists a frame's dispatches and moves the iterates' parity on: call once a frame, then record all of it.
  std::span<const Step> frame(const FrameInput& input);

  /// The dispatches of a frame's end alone: the surface of the pose at hand.
  std::span<const Step> surface();

  /// Copies what the frame is told into the GPU's buffers; visible to the steps after it.
  void record_input(compute::Recorder& recorder, const FrameInput& input) const;
  void record_step(compute::Recorder& recorder, const Step& step) const;

  const Plan& plan() const { return plan_; }
  /// Must be a buffer of the plan. `predicted` and `relaxed` by name, not by role.
  const compute::Buffer& buffer(gpu::Binding binding) const;
  /// What the passes use of it; its memory is rounded up.
  std::uint64_t used_bytes(gpu::Binding binding) const;
  bool has(gpu::Binding binding) const { return plan_.buffers() >> binding & 1; }
  /// All of them with their sizes, in the order of bindings.
  std::vector<const compute::Buffer*> buffers() const;
  const ContactSizes& contact_sizes() const { return contacts_; }
  /// Where the origin of particles' positions lies in the world that the renderer draws (m).
  void set_origin(Vec3 origin) { origin_ = {origin.x, origin.y, origin.z}; }
  /// Which of the two iterates the next frame begins with; a frame that is to be run again needs it back.
  std::uint32_t parity() const { return parity_; }
  void set_parity(std::uint32_t parity) { parity_ = parity; }
  /// Substeps modulo 3: where in gpu::Acceleration the next one finds its predecessors.
  std::uint32_t turn() const { return turn_; }
  void set_turn(std::uint32_t turn) { turn_ = turn; }

 private:
  struct PassResources {
    compute::DescriptorLayout storage_layout, texel_layout;
    compute::OwnedPipelineLayout layout;
    compute::ComputePipeline pipeline;
  };
  struct PassSets {
    compute::DescriptorSet storage[2], texel[2];   // by parity
  };
  Result<compute::Arena> create_arena(bool grows) const;
  Result<void> create_buffers(const Scene& scene, const CookedFabric& fabric);
  Result<void> create_pipelines(const compute::PipelineCache& cache);
  Result<void> write_sets();
  void list_stage(Stage stage, const FrameInput& input, gpu::Push push);
  void set_round(Domain domain, std::uint32_t round, gpu::Push& push) const;
  std::uint64_t mask(std::uint64_t bindings, std::uint32_t parity) const;

  const compute::Device* device_ = nullptr;
  SolverSettings settings_;
  Plan plan_;
  std::vector<BufferNeed> needs_;
  std::vector<std::uint32_t> counts_;   // threads of each pass
  std::vector<std::uint32_t> rounds_;   // dispatches of each pass where it is listed once
  std::vector<std::uint32_t> colour_ends_;
  compute::Arena arena_, growing_arena_;
  std::vector<PassResources> resources_;   // of each pass: a device need not have room for all bindings in one
  std::vector<PassSets> sets_;             // of each pass
  std::vector<Step> steps_;
  ContactSizes contacts_;
  std::uint32_t triangles_ = 0, edges_ = 0;
  std::array<std::uint32_t, WEFT_SHAPES> colliders_{};   // of each shape
  std::uint32_t tether_pairs_ = 0, stretch_stride_ = 0, contact_iterations_ = 0, workgroup_ = 0, parity_ = 0, turn_ = 0, cloths_ = 0;
  bool damped_ = false;   // some spring is
  gpu::vec3 origin_{};
  double h_ = 0, rho_ = 0, jacobi_weight_ = 0;
};

}  // namespace weft
