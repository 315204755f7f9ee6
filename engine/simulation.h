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
//   submit   submits and returns at once; the frame can be drawn by what is later on the queue, and ready_semaphore() tells others
//   record   records into the host's own command buffer, which the host submits on Weft's queue family
//
// Time: a simulation takes fixed substeps of 1 / (rate substeps) seconds, so that the material does not change with the
// frame rate. The rest of a frame is carried over to the next one. A frame longer than SolverSettings::longest_advance is
// clamped, and Advance::clamped reports the surplus.
//
// Threads: a Simulation may be used from any thread, by one at a time. Several may share a device.
//
// Contacts (Scene::contacts): no vertex, edge or triangle of cloth crosses another. This does not hold where anchors or mesh
// colliders are driven through each other or through cloth that cannot give way, nor where cloth crosses itself at the start; and the
// two lips of a tear may pass each other next to a point where they were one.
//
// Origin: far from the origin of the world floats are coarse, a millimetre at 10 km. A simulation therefore has an origin of
// its own near the cloth; it is the world's for cloth within 8 m of that. What a host sets and draws is in world space:
// targets, colliders' poses, render vertices. Particles, the cooked fabric and the meshes are relative to origin().
//
// Errors: a sentence with a kind (compute/result.h), by which a program can decide what to do. Every function that returns a Result
// may fail for want of the host's memory, and every one that waits, submits or copies by what Vulkan refuses: no memory of the
// device's, a lost device. What it was to change is then as it was, or whole, or its comment says otherwise. After an
// error of advance, submit or record the simulation is consistent and can go on: the clock has moved by that frame, the cloth
// may not have. After a lost device every call fails; the simulation can only be destroyed.
//
// A host's device (compute/device.h) need not have any feature enabled. Without synchronization2 barriers have the nearest stages and
// accesses of Vulkan 1.0, and the semaphore of `submit` is signalled after all that is earlier on the queue; without timelineSemaphore
// there is none, and what follows on the queue needs none. The results are the same bits.
//
// Limitations: a mesh collider that rotates moves each vertex along a straight line to its place at the frame's
// end; hosts that record must record frames in the order they submit
// them.
#pragma once

#include <vulkan/vulkan_core.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compute/device.h"
#include "compute/readers.h"
#include "compute/result.h"
#include "engine/counts.h"
#include "engine/fabric.h"
#include "engine/frame_view.h"
#include "engine/mesh.h"
#include "engine/metrics.h"
#include "engine/moving_frame.h"
#include "engine/reaction.h"
#include "engine/scene.h"
#include "engine/snapshot.h"
#include "engine/target_buffer.h"

namespace weft {

struct Curve;

struct SimulationOptions {
  /// A timestamp pair around every pass. It costs time: measure whole frames without.
  bool timings = false;
  /// Time passes on the CPU, each submitted alone, also where the GPU has timestamps.
  bool timings_on_cpu = false;
  /// A file in which specialised and compiled pipelines are saved between runs; empty: none. One for all simulations of a device: what they
  /// share is compiled, and saved, once.
  std::filesystem::path pipeline_cache;
  /// Gather through storage buffers instead of texel buffers (shared.h says what that is for).
  bool gather_storage = false;
  /// Whether threads that have nothing to do cost as much as others, as on the software driver: which passes contacts take where little is
  /// near. As the device has it where it is not said; the same bits either way.
  std::optional<bool> idle_costs = {};
  /// What "method": "auto" chooses from (reference/choice.h); null: the built-in curve. Read in create only.
  const Curve* curve = nullptr;
  /// Threads a workgroup; 0 chooses for the device.
  std::uint32_t workgroup = 0;
  /// Who reads positions() and normals() in the host's commands, in whatever frame. A frame begins by waiting for these stages, besides
  /// compute shaders and copies, which Weft's own commands are; it ends by making its results visible to these accesses of theirs.
  /// Empty: vertex input, vertex shaders, compute shaders and copies. Other readers, fragment shaders or builds of acceleration
  /// structures, must be named here, or kept apart by barriers of the host's. Examples, and what is refused: compute/readers.h.
  std::optional<compute::Readers> readers;
  /// What else the buffers of positions() and normals() are created for: VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT, or
  /// VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR besides it. What takes a feature is refused unless the
  /// feature is enabled (BorrowedDevice::created_with).
  VkBufferUsageFlags vertex_usage = 0;
};

/// What a frame did with the seconds it was given.
struct Advance {
  std::uint32_t substeps = 0;
  double simulated = 0;   // s
  double clamped = 0;     // s, beyond longest_advance: not simulated, now or later
  /// Candidate pairs that found no room and hold their particles still instead: with advance in this frame, where the device has no memory
  /// for more; with submit and record in frames that are done and were not told of yet.
  std::uint32_t pairs_lost = 0;
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
  std::uint32_t dispatches_per_frame = 0;   // at the scene's rate; links' have up to five times as many where anchors are hasty
  std::uint32_t instructions = 0;           // SPIR-V of the specialised module's functions
};

struct BufferUse {
  std::string name;
  std::uint64_t bytes = 0;
};

/// How a hand pulls: a spring to its target with damping against the target's motion, which gives no more than its force.
struct Grip {
  double stiffness = 200;   // N/m, > 0, at most 1e9
  double damping = 2;       // N s/m, >= 0, at most 1e9
  double force = 20;        // N, > 0, at most 1e9
};

/// What a hand has got hold of.
struct Grabbed {
  std::uint32_t grab = 0;   // its number, below Scene::grabs
  std::uint32_t cloth = 0;
  Vec3 point;               // m, world space: of the cloth; where its target is until it is moved
  double distance = 0;      // m, along the ray or from the point
};

class Simulation {
 public:
  /// Loads the scene's meshes, cooks, allocates, compiles. `device` must outlive the simulation. Errors: what check(scene) names; a
  /// mesh that load_mesh or cook refuses; with the method "auto" a curve without a point that counts; a particle that would start, or
  /// a link that is, farther than floats allow; more particles, candidate pairs (contacts.capacity) or threads a workgroup than the
  /// device takes; readers or a vertex usage that the device cannot have; more dispatches a frame than can be recorded; what Vulkan
  /// refuses. A pipeline cache that cannot be read or written is no error; the fabric's notes say if it was not written.
  static Result<std::unique_ptr<Simulation>> create(const compute::Device& device, const Scene& scene,
                                                    const SimulationOptions& options = {});
  /// The same with meshes that the caller made: one a cloth, in its rest pose in world space, then one a mesh collider, in the
  /// collider's own axes, then one for each cloth with a `render_mesh` (any text, then), where that cloth rests. Errors: also another
  /// number of meshes, or one that check(mesh) refuses.
  static Result<std::unique_ptr<Simulation>> create(const compute::Device& device, const Scene& scene, std::vector<Mesh> meshes,
                                                    const SimulationOptions& options = {});
  /// Waits for the frames that Weft has submitted; those that a host has recorded must be done. The software driver of Mesa 22.3 has a look
  /// at a timeline semaphore when it has signalled it already: a host that lent its device there, with timelineSemaphore, and has called
  /// advance or submit, calls vkQueueWaitIdle first. Fences, by which Weft waits on a device without that feature, need no such care.
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Simulates `seconds` >= 0, submits and waits. Where candidate pairs overflowed it enlarges their capacity and repeats the
  /// frame. Errors: `seconds` not finite or negative; memory; what Vulkan refuses.
  Result<Advance> advance(double seconds);

  /// Simulates `seconds`, waiting on the GPU for `waits` first (timelines or binary semaphores); returns at once. What is submitted to the
  /// queue afterwards may draw the frame; others may once ready_semaphore(), a timeline, has reached ready_value(). At most two frames are
  /// in flight: a third waits for the first, and has more room where that one's candidate pairs took more than a third of it. The frame
  /// begins and ends as with record: the stages of each of `waits` must include one that it waits for there. The semaphore is signalled
  /// after all earlier commands on the queue; with readers, without timings, and on a device with synchronization2, after the earlier
  /// compute shaders and copies alone.
  /// Errors: as advance.
  Result<Advance> submit(double seconds, std::span<const VkSemaphoreSubmitInfo> waits = {});
  /// VK_NULL_HANDLE on a device without the feature timelineSemaphore (Device::features). A host that draws on another queue then signals
  /// a semaphore of its own by an empty submit to this queue, and one whose CPU wants to know a fence.
  VkSemaphore ready_semaphore() const;
  /// How many frames Weft has submitted, on any device.
  std::uint64_t ready_value() const;

  /// Records `seconds` into the host's command buffer (recording state, outside a render pass, on the queue family of the device). Of a
  /// scene with cloth that tears at most two may be under way: it waits for the third last. Of what is earlier on the queue it waits for
  /// compute shaders, copies and SimulationOptions::readers, and it makes positions and normals visible to the readers behind it: between
  /// readers and frames the host needs no barriers. Any number of recorded frames may be under way; each is submitted once, in the order in
  /// which they were recorded, to one queue. The simulation may be destroyed when they are done. Candidate pairs get more room where a
  /// frame that is done by now took more than a third of it; up to four frames under way are asked. Before advance, submit and every call
  /// that waits the host's recorded frames must be done: these calls read the last frame's counters. Errors: `seconds` not finite or
  /// negative.
  Result<Advance> record(VkCommandBuffer commands, double seconds);

  /// Makes room for so many candidate pairs of contacts, if there is less; nothing without contacts. Room grows by itself, before it is
  /// needed: call this where the first frames may have more pairs at once than Contacts::capacity gives, with Counts::contacts_room of an
  /// earlier run. It does not wait, and changes nothing but the room. Errors: more than kMostCandidates; no memory; what the device
  /// refuses. The room is then as it was.
  Result<void> reserve_contacts(std::uint32_t pairs);

  /// Positions (m, world space) and unit normals of every render vertex, cloth after cloth, then mesh collider after mesh
  /// collider, then render mesh after render mesh (CookedFabric says where each begins): RGBA32F, 16 bytes apart. Valid until the
  /// simulation is destroyed.
  FrameView positions() const;
  FrameView normals() const;

  /// Targets for the end of the next frame (m, world space), in CookedFabric::anchors' order from `first` on. The host drives
  /// these anchors from now on, instead of the scene's keys. With contacts, cloth in an anchor's way can hold it back from its
  /// target, by at most Contacts::kinematic_lag_limit (8) times the larger thickness of the two. Errors: beyond the last anchor;
  /// a target that is not finite, or 1e10 m away or more. Nothing has changed then.
  Result<void> move_anchors(std::uint32_t first, std::span<const Vec3> targets);
  /// Pins vertices of cloth (numbers as in positions()) from the next frame on, each where it is then: it is held as an anchor is, and gets
  /// tethers as from one. What is held already stays as it is. Does not wait; the next frame cooks lists anew on the CPU (engine/README.md,
  /// "Hands", says how long that takes). Errors: a scene without `pins`, or with fewer than it takes; no such vertex; one of a mesh
  /// collider. Nothing has changed then.
  Result<void> pin(std::span<const std::uint32_t> vertices);
  /// Lets go of vertices, pinned or the scene's own anchors, from the next frame on: each flies on with the velocity that it had in the
  /// last substep, with its own mass, and its tethers are gone. What is not held stays free. pin() holds a released anchor again, without a
  /// pin of the scene's, and without its keys. Does not wait, and costs what pin() does. Errors: as pin.
  Result<void> release(std::span<const std::uint32_t> vertices);
  /// Targets for the end of the next frame (m, world space) of vertices that are held, pinned or anchors, one each; as with move_anchors.
  /// Errors: another number of targets; a vertex that is not held, or that pin refuses; a target that is not finite, or 1e10 m away or
  /// more. Nothing has changed then.
  Result<void> move_pins(std::span<const std::uint32_t> vertices, std::span<const Vec3> targets);

  /// Takes hold of the cloth where a ray (m, world space; any length of direction) first meets it, from either side; nothing where it meets
  /// none. From the next frame on `grip` pulls that place to its target. The CPU looks for it among all triangles of the cloth as it is:
  /// waits, and copies positions back; frames that a host has recorded must be done. Colliders hide nothing: a host that knows of one in
  /// front compares distances. Errors: no free place among the scene's `grabs`; a ray that is not finite, or without a direction; a grip
  /// out of its limits; memory; what Vulkan refuses.
  Result<std::optional<Grabbed>> grab(Vec3 origin, Vec3 direction, const Grip& grip = {});
  /// The same at the point of the cloth that is nearest to `point` (m, world space).
  Result<Grabbed> grab_near(Vec3 point, const Grip& grip = {});
  /// The target for the end of the next frame (m, world space); it goes there in a straight line. Errors: nothing is held by that
  /// number; not finite, or 1e10 m away or more.
  Result<void> move_grab(std::uint32_t grab, Vec3 target);
  /// Lets go: from the next frame on the cloth flies on with the velocity that it has. Errors: nothing is held by that number.
  Result<void> let_go(std::uint32_t grab);

  /// Cuts all cloth that tears (Cloth::tear) along a blade, the part of a plane between two rays from `origin` (m, world space; any length
  /// of direction), as a mouse that is drawn over the picture makes it, and returns how many vertices have become two. Triangles stay
  /// whole: each that the blade meets goes to the side on which most of it lies. What is held is not cut. meshes() and positions() are of
  /// the cut cloth at once. Waits, and cooks the cloth anew on the CPU. What spare vertices do not suffice for is not cut
  /// (Counts::splits_refused). Errors: no cloth that tears; a blade that is not finite, or without an angle; memory; what Vulkan refuses.
  Result<std::uint32_t> cut(Vec3 origin, Vec3 a, Vec3 b);
  /// Splits a cloth that tears as another simulation of the same mesh has torn (splits_of), and returns how many vertices have become two.
  /// Errors: as cut; no such cloth; a split that split_points refuses. Nothing has changed then.
  Result<std::uint32_t> split(std::uint32_t cloth, std::span<const Split> splits);
  /// How a cloth has torn so far, in order; empty where it does not tear. Valid until the next frame, cut, split or restore.
  std::span<const Split> splits_of(std::uint32_t cloth) const;
  /// How many vertices have become two so far, by tearing and cutting. When that has changed after a frame, meshes() has: drawn triangles,
  /// whose number stays, have other vertices from that frame on, of which there have been as many from the start. A frame that tears cooks
  /// the cloth anew on the CPU (engine/README.md, "Tearing", says how long that takes).
  std::uint32_t splits() const;

  /// The complete pose for the end of the next frame (world space; a capsule or a box without a rotation stands along its own
  /// axes). The host drives this collider from now on, instead of the scene's keys. It rotates by the shorter arc. Errors: no
  /// such collider, or one with a bone; a pose that is not finite, or 1e10 m away or more; a normal or rotation of length 0.
  Result<void> move_collider(std::uint32_t collider, const ColliderPose& pose);
  /// The same of several, in the scene's order from `first` on; all of them or, with an error, none.
  Result<void> move_colliders(std::uint32_t first, std::span<const ColliderPose> poses);
  /// Puts the collider there at once; it meets no cloth on the way. A pending pose of move_collider is dropped; keys, where they
  /// drive the collider, move it on from there, and so does a bone. Together with write_positions, which does the same to cloth and its
  /// anchors, this teleports a scene. Waits if it is a mesh collider. Errors: as move_collider; what Vulkan refuses.
  Result<void> place_collider(std::uint32_t collider, const ColliderPose& pose);
  /// The size for the end of the next frame, of a collider that the scene says may be resized (Collider::resizes): it grows or shrinks
  /// evenly through the frame about its centre, and pushes cloth no faster than its surface moves. Errors: no such collider, or one that
  /// may not be resized; a size outside a scene's limits. Nothing has changed then.
  Result<void> resize_collider(std::uint32_t collider, const ColliderSize& size);
  /// From the next frame on (m/s^2). Errors: not finite, or 1e10 m/s^2 or more; the gravity is then as it was.
  Result<void> set_gravity(Vec3 gravity);
  /// From the next frame on (m/s): gusts and turbulence come on top, and eddies go with it. Errors: a scene without air; not finite, or
  /// above kFastestWind; the wind is then as it was.
  Result<void> set_wind(Vec3 wind);
  /// Where a field of the scene's air is (m) and its velocity (m/s), from the next frame on. Errors: no such field; a place that is not
  /// finite, or 1e10 m away or more; a velocity that set_wind refuses. Nothing has changed then.
  Result<void> move_air_field(std::uint32_t field, Vec3 centre, Vec3 velocity);

  /// The pose of a cloth's skin (Cloth::skin) for the end of the next frame: for each joint the map from the cloth at rest, as make_meshes
  /// has it, to where the joint takes it (world space), the product of the joint's matrix and its inverse bind matrix in other words. The
  /// host drives the skin from now on, instead of an animation; a frame without a new pose holds still. Anchors without keys go there,
  /// colliders with a bone go along, and motion constraints follow, evenly through the frame. Errors: no such cloth, or none with a skin;
  /// another number of joints than its mesh has (1 without a skin of its own); a map that is not finite. Nothing has changed then.
  Result<void> set_pose(std::uint32_t cloth, std::span<const Affine> joints);
  /// The same of a mesh collider (Collider::skin): maps from its shape at rest to its shape, in its own axes; its pose comes on top.
  Result<void> set_body_pose(std::uint32_t collider, std::span<const Affine> joints);
  /// The weights of the morph targets of a cloth's skin (Skin::morphs) for the end of the next frame: each moves points by its deltas times
  /// its weight, before joints carry them. The host sets the weights from now on, instead of an animation, which goes on moving the joints
  /// unless set_pose does; a frame without new ones holds still. What follows the pose follows them, evenly through the frame. Errors: no
  /// such cloth, or none with a skin; another number of weights than its mesh has morph targets; one below -1e6, above 1e6 or not a number.
  /// Nothing has changed then.
  Result<void> set_morphs(std::uint32_t cloth, std::span<const float> weights);
  /// The same of a mesh collider.
  Result<void> set_body_morphs(std::uint32_t collider, std::span<const float> weights);
  /// Where the points of a cloth's skin are at the end of the next frame (world space), by the host's own skinning on the GPU, in place of
  /// joints and weights; of a skin that says so in the scene (Skinning::takes_targets). Anchors without keys go there and motion
  /// constraints follow, evenly through the frame, which begins where the one before ended. A frame without a new buffer holds still; one
  /// with a new pose or new weights alone goes from there to where these have the points. The animation stands still from now on; colliders
  /// with a bone and a joint for `inertia` go with set_pose, which may be called in the same frame. The same positions give the same bits
  /// as set_pose, with an origin of 0; else they are rounded once more, relative to origin(). A place that is not finite, or 1e10 m away or
  /// more, is counted in Counts::non_finite; the point then holds still. A snapshot has where points are, but no buffer that waits for the
  /// next frame. Errors: a cloth that takes none; no buffer; another number of vertices. Nothing has changed then.
  Result<void> set_targets(std::uint32_t cloth, const TargetBuffer& targets);
  /// The same of a mesh collider: its whole shape in world space, on which its pose then has no influence. place_collider takes it along as
  /// it takes the pose.
  Result<void> set_body_targets(std::uint32_t collider, const TargetBuffer& targets);
  /// Where the frame that a cloth goes with (Cloth::inertia) is at the end of the next frame (world space). The host drives it from now on,
  /// instead of a joint; without a joint the first call says where it is. A frame of the simulation without a new place holds still. Turns
  /// by the shorter arc. Errors: no such cloth, or one without `inertia`; a place or rotation that is not finite, or no rotation. Nothing
  /// has changed then.
  Result<void> move_frame(std::uint32_t cloth, const MovingFrame& frame);
  /// Takes a cloth from one frame to another at once, without a trace: places and velocities turn along, anchors and their targets too, the
  /// pose of its skin with the colliders of its bones, and its frame. Keys and animations move anchors back where they have them; what the
  /// host has set for the next frame stays set. Other colliders are taken along by place_collider. Waits. Errors: no such cloth; a frame
  /// that move_frame refuses; cloth that would be 1e10 m away or more (nothing has changed then); memory; what Vulkan refuses.
  Result<void> teleport(std::uint32_t cloth, const MovingFrame& from, const MovingFrame& to);

  /// From the next frame on: what a cloth's max distances are multiplied by (0 ... 1e6), and the stiffness of its motion constraints (0 ...
  /// 1). Errors: a cloth without motion constraints; other values. Nothing has changed then.
  Result<void> limit_motion(std::uint32_t cloth, double scale, double stiffness);

  /// How much gas a cloth holds from the next frame on, as a multiple of the scene's amount (Cloth::pressure), 0 ... 1e3: it starts
  /// with 1; 0 is a vacuum, on which the ambient pressure closes. Errors: no gas in the cloth; another amount. Nothing has changed then.
  Result<void> inflate(std::uint32_t cloth, double amount);

  /// The origin of the particles' positions, in world space (m); chosen at create.
  Vec3 origin() const;

  /// Seconds simulated so far.
  double time() const;
  /// Poses of the scene's colliders at the last frame's end (world space), in the scene's order; valid until colliders() is
  /// called again.
  std::span<const ColliderPose> colliders() const;
  /// Their sizes at the last frame's end, in the scene's order; valid until the next frame.
  std::span<const ColliderSize> collider_sizes() const;

  /// What cloth has done to each of the scene's colliders, in the scene's order, since the last call, or since create or restore: in
  /// frames that are done. It does not wait: after advance the frame is among them; after submit and record some of the last may not be,
  /// and come with the next call. Nothing is lost or told twice. Empty where the scene does not ask for reactions. Valid until the
  /// next call.
  std::span<const Reaction> take_reactions();
  /// The same of the scene's grabs, an entry each: what cloth pulls hands by, so that a host can attach it to its rigid bodies: it moves a
  /// grab to where the body has it, and gives the body this impulse there. What a substep gave is known when the next one begins. Exact as
  /// long as nothing pushes a grabbed particle but what sees its mass in the solve (engine/README.md, "Hands"). Empty where the scene does
  /// not ask for reactions. Valid until the next call.
  std::span<const Reaction> take_pulls();

  /// Of the last frame of advance or submit; empty without SimulationOptions::timings. On devices without timestamps the CPU
  /// measures each pass, and timed_on_cpu() is true. Empty, too, where there is no memory for the list.
  std::vector<PassTiming> timings() const;
  std::vector<DispatchTime> dispatch_times() const;
  bool timed_on_cpu() const;
  /// Milliseconds on the GPU from a frame's first to its last command; 0 without timings.
  double gpu_milliseconds() const;

  /// What the scene's plan consists of: passes with their dispatches a frame, and buffers with their bytes. Empty where there is no
  /// memory for the list.
  std::vector<PassUse> passes() const;
  std::vector<BufferUse> buffers() const;
  /// Of the last frame that is done. Frames that a host has recorded must be.
  Counts counts() const;

  /// As given to create, with the solver settings chosen where its method is "auto".
  const Scene& scene() const;
  /// One a cloth, relative to origin(), then one a mesh collider, in its own axes, then one a render mesh, as the cloths. Cloth that tears
  /// has spare vertices of no triangle at its end, and is torn as in the last frame.
  const std::vector<Mesh>& meshes() const;
  /// Lists that depend on who is held are those of the last frame.
  const CookedFabric& fabric() const;
  const compute::Device& device() const;

  /// Copies back all particles, of cloths and mesh colliders, in CookedFabric's order: xyz position relative to origin() (m), w
  /// inverse mass (1/kg); xyz velocity (m/s), w the material's index as bits. Waits for the last submitted frame. Errors: memory; what
  /// Vulkan refuses.
  Result<std::vector<gpu::vec4>> read_positions() const;
  Result<std::vector<gpu::vec4>> read_velocities() const;
  /// Overwrites the positions or velocities of all particles, of mesh colliders too (CookedFabric's order, units as above; w is
  /// ignored). Waits. A value that is not finite, or of 1e10 or more, is counted in Counts::non_finite and sanitized: the
  /// particle stays where it is, or moves as its neighbours do, with velocity 0; no other particle is affected. A written
  /// position is also an anchor's target until keys or move_anchors set another: an anchor that cloth held back, written where
  /// it was read, gives up its former target. Errors: another number of values than particles; memory; what Vulkan refuses. Written
  /// positions of which only the surface could not be made anew are written all the same. With solver.order 2 what is kept of the last
  /// substep stays as it is (shaders/bdf2/bdf2.glsl).
  Result<void> write_positions(std::span<const gpu::vec4> positions);
  Result<void> write_velocities(std::span<const gpu::vec4> velocities);
  /// The whole state, to continue from later or in another process (engine/snapshot.h). Waits; frames that a host has recorded
  /// must be done. Errors: memory; what Vulkan refuses.
  Result<Snapshot> save() const;
  /// Continues from a snapshot: what follows is bitwise the same as after save(). With submit and record, which do not repeat
  /// frames in which contacts overflowed, this also takes the same capacity for contacts as then. Waits. Errors: a snapshot of
  /// another scene, or a state that this scene cannot be in; nothing has changed then. No memory: the simulation is in one of
  /// the two states, and the next frame may detect contacts once more.
  Result<void> restore(const Snapshot& snapshot);
  /// Whether restore would accept it. Errors: as restore, except for want of memory.
  Result<void> fits(const Snapshot& snapshot) const;
  /// Positions (m, world space) and normals of all render vertices, copied back. Waits. Errors: memory; what Vulkan refuses.
  Result<std::vector<Vec3>> read_vertex_positions() const;
  Result<std::vector<Vec3>> read_vertex_normals() const;

 private:
  struct State;
  explicit Simulation(std::unique_ptr<State> state);
  static Result<std::unique_ptr<Simulation>> create_at(const compute::Device& device, const Scene& scene, Vec3 origin,
                                                       std::vector<Mesh> meshes, const SimulationOptions& options);
  std::unique_ptr<State> state_;
};

}  // namespace weft
