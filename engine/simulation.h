// Weft's public API: a scene goes in, frames of moving cloth come out.
//
//     auto device = weft::compute::Device::create();
//     auto scene = weft::load_scene("curtain.json");
//     auto simulation = weft::Simulation::create(**device, *scene);
//     (*simulation)->advance(1.0 / 60);
//     weft::FrameView positions = (*simulation)->positions();   // bind it as a vertex buffer
//
// Everything is allocated and compiled in create; a frame only records. Three ways to run a frame:
//   advance  submits and waits; for tools and tests
//   submit   submits and returns at once; `ready` is signalled when the frame can be drawn
//   record   records into the host's own command buffer, which the host submits on Weft's queue family
//
// Time: a simulation takes fixed substeps of 1 / (rate substeps) seconds, so that the material does not change with the
// frame rate. What is left over is kept for the next frame; a frame longer than Scene::solver.longest_advance is
// clamped, and the surplus is in the report, never silently lost.
//
// Threads: a Simulation may be used from any thread, by one at a time. Several may share a device.
//
// Contacts (Scene::contacts): no vertex, edge or triangle of cloth crosses another. The promise ends where anchors or mesh colliders
// are driven through cloth that cannot go away, or through each other, and where cloth crosses itself from the start.
//
// Far from the origin of the world floats are coarse: a millimetre at 10 km. A simulation therefore works about an origin of its own near
// the cloth, which is the world's for cloth within 8 m of that. What a host says and draws is in its world: targets, colliders' poses,
// render vertices. Particles, the cooked fabric and the meshes are about origin().
//
// Errors: what Vulkan refuses is a sentence, with a kind (compute/result.h) that tells a program what to do about it. After one of advance, submit or record the simulation is whole and can go on: the clock has
// moved by that frame, the cloth may not have. After a lost device everything fails, and all that is left is to destroy it.
//
// Limitations: no wind yet; a mesh collider that turns takes its vertices straight to where they
// are at the frame's end; anchors are chosen at create and can be moved, not added; hosts that record must record frames in
// the order they submit them.
#pragma once

#include <vulkan/vulkan_core.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compute/device.h"
#include "compute/result.h"
#include "engine/fabric.h"
#include "engine/frame_view.h"
#include "engine/mesh.h"
#include "engine/metrics.h"
#include "engine/scene.h"
#include "engine/snapshot.h"

namespace weft {

struct Curve;

struct SimulationOptions {
  /// A timestamp pair around every pass. Costs time: whole-frame times are taken without.
  bool timings = false;
  /// Time passes on the CPU, each submitted alone, also where the GPU has timestamps.
  bool timings_on_cpu = false;
  /// Compiled pipelines are kept in this file between runs; empty: not kept.
  std::filesystem::path pipeline_cache;
  /// Gather through storage buffers instead of texel buffers (shared.h says what that is for).
  bool gather_storage = false;
  /// What "method": "auto" chooses from (reference/choice.h); null: the curve that is built in. Read in create only.
  const Curve* curve = nullptr;
  /// Threads a workgroup; 0 chooses for the device.
  std::uint32_t workgroup = 0;
};

/// What a frame did with the seconds it was given.
struct Advance {
  std::uint32_t substeps = 0;
  double simulated = 0;   // s
  double clamped = 0;     // s, beyond longest_advance: not simulated, not kept
};

struct PassTiming {
  std::string name;       // pass; all its dispatches of the frame together
  std::uint32_t dispatches = 0;
  double milliseconds = 0;
  double first_begin_ms = 0;   // since the frame's start
};

/// One dispatch, for traces.
struct DispatchTime {
  std::string name;
  double begin_ms = 0, end_ms = 0;   // since the frame's start
};

struct PassUse {
  std::string name;
  std::uint32_t dispatches_per_frame = 0;   // at the scene's rate
};

struct BufferUse {
  std::string name;
  std::uint64_t bytes = 0;
};

/// Counts since create. The first two and contacts_lost are zero in a healthy run.
struct Counts {
  std::uint32_t non_finite = 0;   // particles put back to their last finite position
  std::uint32_t coincident = 0;   // links whose ends were at one place, pushed apart along a line of no meaning (springs that only pull, and those of the method implicit: left alone)
  std::uint32_t contacts_most = 0;   // pairs that could meet, the most that one detection found
  std::uint32_t contacts_overflowed = 0;   // pairs that found no room and held their particles still instead: with record and submit, and where the device has no more room
  std::uint32_t truncated = 0;       // times that a particle, or an anchor, was stopped short so that no cloth crosses another; perhaps several times a substep
  std::uint32_t detections = 0;      // searches for pairs
  float tracking_error = 0;          // m: how far behind its target cloth held an anchor, or a mesh collider's corner, at most
  // Method implicit only. The norm of a residual r is r . D^-1 r, D the blocks on the matrix's diagonal.
  std::uint32_t unconverged = 0;     // substeps whose solve left more than 1 % of the free flight's residual
  std::uint32_t stopped = 0;         // substeps whose solve was broken off with the best there was
  float residual = 0;                // of the last substep's, before its last iteration: the part that was left
  std::uint32_t unaccelerated = 0;   // substeps that the method chebyshev finished as jacobi, because its acceleration was not steady
};

class Simulation {
 public:
  /// Loads the scene's meshes, cooks, allocates, compiles. `device` must outlive the simulation.
  static Result<std::unique_ptr<Simulation>> create(const compute::Device& device, const Scene& scene,
                                                    const SimulationOptions& options = {});
  /// The same with meshes that the caller made: one a cloth, already where the cloth hangs at rest, then one a mesh collider, in the
  /// collider's own axes.
  static Result<std::unique_ptr<Simulation>> create(const compute::Device& device, const Scene& scene, std::vector<Mesh> meshes,
                                                    const SimulationOptions& options = {});
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Simulates `seconds` >= 0, submits and waits. Errors: seconds not finite or negative; a lost device.
  Result<Advance> advance(double seconds);

  /// Simulates `seconds`, waiting on the GPU for `waits` first; returns at once. The frame may be drawn by what waits for
  /// ready_semaphore() to reach ready_value(). At most two frames are under way: a third waits for the first.
  Result<Advance> submit(double seconds, std::span<const VkSemaphoreSubmitInfo> waits = {});
  VkSemaphore ready_semaphore() const;
  std::uint64_t ready_value() const;

  /// Records `seconds` into the host's command buffer (recording state, outside a render pass, on the queue family of the
  /// device). Barriers to and from vertex input, host copies and earlier frames are recorded too. Whatever else is called next that waits, or
  /// advance or submit, needs the host's frames done: it may give contacts more room, in other buffers, and reads what the last frame counted.
  Result<Advance> record(VkCommandBuffer commands, double seconds);

  /// Of every render vertex, cloth after cloth, then mesh collider after mesh collider: RGBA32F, 16 bytes apart. Valid until the simulation is destroyed.
  FrameView positions() const;
  FrameView normals() const;

  /// Targets for the end of the next frame, in world space, in CookedFabric::anchors' order from `first` on; they replace the
  /// scene's keys for these anchors from now on. Among contacts an anchor may wait for cloth in its way, up to eight times the larger thickness of the two from there, or what Scene::contacts.kinematic lag limit says. Errors: beyond the last anchor; not finite, or 1e10 m away or more.
  Result<void> move_anchors(std::uint32_t first, std::span<const Vec3> targets);
  /// Pose for the end of the next frame, whole (a capsule or a box without a rotation stands along its own axes); replaces the scene's
  /// keys for this collider. It turns there the shorter way round. Errors: no such collider; not finite; a normal or rotation of length 0.
  Result<void> move_collider(std::uint32_t collider, const ColliderPose& pose);
  /// Is there at once, without a way there that cloth could meet, and a wish of move_collider is forgotten; keys take it on from there. With
  /// write_positions, which does the same to cloth and its anchors, a host sets a scene elsewhere. Of a mesh collider: waits. Errors: as
  /// move_collider; a lost device.
  Result<void> place_collider(std::uint32_t collider, const ColliderPose& pose);
  /// From the next frame on (m/s^2). Errors: not finite.
  Result<void> set_gravity(Vec3 gravity);

  /// Where particles' positions count from, in the host's world (m); chosen at create.
  Vec3 origin() const;

  /// Seconds simulated so far.
  double time() const;
  /// Where the scene's colliders are now.
  std::span<const ColliderPose> colliders() const;

  /// Of the last frame that was finished by advance or submit; empty without SimulationOptions::timings. On devices without timestamps the
  /// figures are the CPU's around each pass, and timed_on_cpu() says so.
  std::vector<PassTiming> timings() const;
  std::vector<DispatchTime> dispatch_times() const;
  bool timed_on_cpu() const;
  /// Milliseconds on the GPU from a frame's first to its last command; 0 without timings.
  double gpu_milliseconds() const;

  /// What the scene's plan made: passes with their dispatches a frame, and buffers with their bytes.
  std::vector<PassUse> passes() const;
  std::vector<BufferUse> buffers() const;
  Counts counts() const;

  const Scene& scene() const;
  /// One a cloth, about origin(), then one a mesh collider.
  const std::vector<Mesh>& meshes() const;
  const CookedFabric& fabric() const;
  const compute::Device& device() const;

  /// Copies all particles back, cloths' and mesh colliders' (CookedFabric's order; about origin()). Waits for the last submitted frame.
  Result<std::vector<gpu::vec4>> read_positions() const;
  Result<std::vector<gpu::vec4>> read_velocities() const;
  /// Overwrites the state of all particles, mesh colliders' too (CookedFabric's order; about origin(); w is ignored): a pose to start from. Waits. A place
  /// or a velocity that is not finite, or 1e10 and more, is counted in Counts::non_finite and mended: the particle stays, or goes along with
  /// its neighbours, and is at rest; all others are as they would be without it. Anchors are led to where they are put until keys or move_anchors
  /// say otherwise: one that waits for cloth (move_anchors) and is written where it was read waits no more.
  Result<void> write_positions(std::span<const gpu::vec4> positions);
  Result<void> write_velocities(std::span<const gpu::vec4> velocities);
  /// The whole state, to go on from here later, in another process or to try something out. Waits; frames that a host has recorded must be done.
  Result<Snapshot> save() const;
  /// Goes on from there: what follows is bitwise the same as after save() (with submit and record, which do not wait for room for contacts,
  /// if there was as much room then). Waits. Errors: a snapshot of another scene, or one that this scene cannot be in: nothing has changed
  /// then. No memory: the simulation is in one of the two states, and what follows may search for contacts once more.
  Result<void> restore(const Snapshot& snapshot);
  /// Whether restore would take it. Errors: as restore, without memory's.
  Result<void> fits(const Snapshot& snapshot) const;
  /// What the renderer sees, copied back: positions and normals of all render vertices. Waits.
  Result<std::vector<Vec3>> read_vertex_positions() const;
  Result<std::vector<Vec3>> read_vertex_normals() const;

 private:
  struct State;
  explicit Simulation(std::unique_ptr<State> state);
  static Result<std::unique_ptr<Simulation>> create_at(const compute::Device& device, const Scene& scene, Vec3 origin, std::vector<Mesh> meshes,
                                                       const SimulationOptions& options);
  std::unique_ptr<State> state_;
};

}  // namespace weft
