// What a Simulation holds; shared by simulation*.cpp.
#pragma once

#include <array>
#include <optional>

#include "compute/commands.h"
#include "engine/effects/buffers.h"
#include "engine/simulation.h"
#include "engine/solve/solver.h"

namespace weft {

/// A frame that Weft itself submits: two take turns.
struct FrameSlot {
  VkCommandBuffer commands = VK_NULL_HANDLE;
  compute::Timestamps timestamps;
  std::uint64_t value = 0;   // of the ready semaphore when it is done; 0: never submitted
};

/// Where a collider stands when its keys say `key`.
ColliderPose keyed_pose(const Collider& collider, const Key& key);

struct Simulation::State {
  const compute::Device* device = nullptr;
  Scene described;                             // as the host gave it
  Scene scene;                                 // told from the origin, as is everything below
  Vec3 origin;                                 // m, in the host's world
  SimulationOptions options;
  std::vector<Mesh> meshes;
  CookedFabric fabric;
  compute::PipelineCache cache;
  std::optional<Solver> solver;
  std::vector<const Buffer*> lasting;          // what a frame leaves to the next one, in the order of rows: Lifetime::kept
  compute::Arena readback;                     // the counters and, with contacts, the detection, copied at every frame's end
  compute::Arena kept;                         // with contacts, or passes one by one: what advance needs to run its frame again
  std::uint32_t found_at_start = 0;            // candidates in it
  std::uint32_t lost_seen = 0;                 // candidates lost by frames that submit has made room after
  bool half_done = false;                      // a frame that passes were timed in one by one stopped in its middle: `kept` is to be put back
  bool room_ends = false;                      // more was asked for and not to be had: not asked for again
  std::optional<std::uint64_t> digest;         // of the scene and its fabric: what a snapshot must be of; made when it is asked for
  compute::CommandPool pool;
  std::array<FrameSlot, 2> slots;
  compute::OwnedSemaphore ready;
  std::uint64_t submitted = 0;                 // the ready semaphore's last value

  std::uint64_t ticks = 0;                     // substeps so far: the clock
  double pending = 0;                          // s, less than a substep
  Vec3 gravity;
  std::vector<gpu::Anchor> anchors;            // from: where they are; to: where the frame takes them; then the mesh colliders' particles
  std::vector<std::optional<Vec3>> anchor_wishes;   // of the anchors alone
  std::vector<bool> anchor_is_led;             // by the host, instead of by keys
  std::vector<ColliderPose> collider_poses;    // where they are
  std::vector<Key> collider_keys;              // what the keys said last
  std::vector<std::uint32_t> collider_order;   // by shape, as the GPU wants them; no meshes
  std::vector<ColliderPose> told_poses;        // the same in the host's world
  std::vector<std::optional<ColliderPose>> collider_wishes;
  std::vector<bool> collider_is_led;
  std::vector<gpu::Collider> colliders;        // of the frame at hand
  bool anchors_are_keyed = false;
  bool anchors_are_owed = false;               // the GPU does not know yet where they are led: a frame has failed, or they were put somewhere

  std::vector<DispatchTime> cpu_times;         // on devices without timestamps
  const FrameSlot* last_timed = nullptr;

  double now() const { return static_cast<double>(ticks) * fabric.h; }
  bool timed_on_cpu() const;
  double dispatches_of(double substeps) const;   // of a frame with so many
  Result<Advance> plan_frame(double seconds, FrameInput& input);
  void move_scene(FrameInput& input);
  Result<ColliderPose> checked_pose(std::uint32_t collider, const ColliderPose& pose) const;
  const ColliderMesh* mesh_of(std::uint32_t collider) const;   // null: it is none
  Vec3 move_collider_on(std::uint32_t collider);
  void move_collider_meshes();
  void record_frame(VkCommandBuffer commands, const FrameInput& input, compute::Timestamps* timestamps, bool keep);
  Result<void> submit_frame(const FrameInput& input, std::span<const VkSemaphoreSubmitInfo> waits, bool keep);
  Result<void> run_pass_by_pass(const FrameInput& input, bool keep);
  Result<void> run_to_the_end(const FrameInput& input);
  Result<void> create_kept();
  void copy_kept(VkCommandBuffer commands, bool back) const;
  Result<void> put_frame_back();
  Result<bool> make_room();
  Result<void> make_room_later();
  Result<void> detect_anew();
  const gpu::Counters& counters() const;
  const gpu::Detection& detection() const { return *reinterpret_cast<const gpu::Detection*>(readback[1].mapped); }
  Result<void> draw_surface();
  std::uint64_t own_digest();
  Result<void> check(const Snapshot& snapshot);
  Result<void> put_back(const Snapshot& snapshot);
  Result<void> wait() const;
  Result<std::vector<gpu::vec4>> read(const Buffer& row, std::size_t count);
  Result<void> put(std::span<const gpu::vec4> positions);
  Result<void> write(std::vector<compute::Upload> uploads, const gpu::Counters& counted);
  Result<void> check_count(std::span<const gpu::vec4> values) const;
  Result<gpu::Counters> counters_and_mended(std::size_t more);
};

}  // namespace weft
