// What a Simulation holds; shared by simulation*.cpp.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "compute/commands.h"
#include "engine/effects/buffers.h"
#include "engine/effects/tear/tear.h"
#include "engine/mesh/parts.h"
#include "engine/simulation.h"
#include "engine/solve/pick.h"
#include "engine/solve/solver.h"

namespace weft {

/// A frame that Weft itself submits: two take turns.
struct FrameSlot {
  VkCommandBuffer commands = VK_NULL_HANDLE;
  compute::Timestamps timestamps;
  std::uint64_t value = 0;   // the number of its last frame; 0: never submitted
  compute::OwnedFence done;  // of that frame, where there is no ready semaphore
};

/// What a frame reports to the host at its end.
struct Report {
  gpu::Counters counters{};
  gpu::Detection detection{};   // with contacts
};

/// The pose of a collider at a key.
ColliderPose keyed_pose(const Collider& collider, const Key& key);

/// Time advances in whole substeps; the rest of a frame's seconds is carried over to the next frame.
struct Clock {
  std::uint64_t substeps = 0;
  double left_over = 0;                        // s, less than a substep
};

/// Kinematic particles, driven by keys or by the host: all anchors, then places for pins, then the particles of mesh colliders. `targets`
/// has an entry for each of them, `pending` and `is_host_driven` for anchors and pins. Targets are uploaded in every frame in which a `from`
/// and a `to` differ, or which finds them dirty.
struct KinematicTargets {
  std::vector<gpu::Anchor> targets;            // from: at the frame's start; to: at its end (m)
  std::vector<std::optional<Vec3>> pending;    // targets that the host has set since the last frame (m)
  std::vector<bool> is_host_driven;            // from the host's first target on, instead of by keys
  std::vector<float> links;                    // mean length of each cloth's links (m)
  float way = 0;                               // the farthest that one goes in this frame, in links of its cloth
  float haste = 0;                             // FrameInput::haste
  bool are_keyed = false;
  bool are_dirty = false;                      // the GPU's copy is not `targets`: a frame has failed, or positions were written
  std::uint64_t still_since = 1;               // the first submitted frame from which on no target has moved
  bool rest = false;                           // since then, by a frame's report: all are where they should be (FrameInput::kinematics_rest)
};

/// Who is held, where the host may pin: the fabric that is cooked for them, and what the GPU is still to be told of it.
struct Holds {
  struct Cooked {
    CookedFabric fabric;
    std::vector<Edit> edits;                   // from the present fabric's lists
  };
  bool are_changed = false;                    // cooked anew where the next frame begins
  bool are_new = false;                        // the next frame detects contacts anew
  std::vector<Edit> edits;                     // until a frame has them
};

/// What has torn: an entry a cloth where the scene has any that tears (engine/solve/tears.cpp).
struct Tears {
  std::vector<Mesh> whole;                     // cloths' meshes as they were, with room to be split
  std::vector<std::vector<Split>> done;        // in their order
  std::vector<std::vector<Split>> found;       // by the last look, for the frame that is due
  std::uint64_t frames = 0;                    // that have simulated anything
  bool looks = false;                          // the frame at hand copies positions back
  bool has_looked = false;                     // one has been sent, and what it saw is not known
  std::uint64_t look = 0;                      // its number among those that Weft submits; 0: a host records it
  compute::OwnedEvent is_seen;                 // set by one of `record`
  std::uint32_t refused = 0;                   // Counts::splits_refused
};

/// What hands pull at: of each grab the corners of a triangle, or nothing.
struct Grabs {
  std::vector<std::optional<Snapshot::GrabState>> held;
  std::vector<gpu::Grab> corners;              // of the frame at hand, three a grab
};

/// Colliders, an entry each in all lists but the last three.
struct Bodies {
  std::vector<ColliderPose> poses;             // at the last frame's end
  std::vector<Key> keys;                       // the keys' last poses
  std::vector<std::optional<ColliderPose>> pending;   // poses that the host has set since the last frame
  std::vector<bool> is_host_driven;
  std::vector<ColliderSize> sizes;               // at the last frame's end
  std::vector<std::optional<ColliderSize>> pending_sizes;
  std::vector<ColliderPose> in_world;            // poses in the host's world
  std::vector<std::uint32_t> order;            // by shape, as the GPU wants them; no meshes
  std::vector<gpu::Collider> colliders;        // of the frame at hand, in that order; with reactions then those of `meshes`
  std::vector<gpu::Collider> meshes;           // of each mesh collider the place of its centre, with reactions
  std::vector<gpu::BodySize> from_sizes;       // where it begins
};

/// Turns about `from` and takes that to `to` (m).
struct RigidMap {
  Eigen::Quaterniond turn;
  Eigen::Vector3d from, to;
  Vec3 place(Vec3 p) const { return parts::narrow(Eigen::Vector3d(to + turn * (parts::wide(p) - from))); }
  Vec3 way(Vec3 v) const { return parts::narrow(Eigen::Vector3d(turn * parts::wide(v))); }
};

/// Skins: their joints, an entry each, and what the host has said, an entry a skinned mesh (SkinLists::meshes).
struct Skins {
  std::vector<Affine> pose;                    // at the last frame's end; of a mesh collider in its own axes
  std::vector<std::vector<Affine>> pending;    // poses that the host has set since the last frame; empty: none
  std::vector<bool> is_host_driven;
  std::vector<gpu::Joint> joints;              // of the frame at hand, in the particles' space
  std::vector<float> weights;                  // of all morph targets, at the last frame's end
  std::vector<std::vector<float>> pending_weights;   // as `pending`
  std::vector<bool> has_host_weights;          // from the host's first ones on, instead of by an animation
  std::vector<gpu::vec2> morph_weights;        // of the frame at hand
  std::vector<std::optional<TargetBuffer>> pending_targets;   // that the host has set since the last frame
  std::vector<bool> are_kept;                  // whose points are where a buffer had them (skin_ends)
  std::vector<gpu::uint> sources;              // of the frame at hand
  std::vector<HostCopy> copies;
  std::vector<gpu::MotionLimits> limits;       // of each cloth
};

/// The frames that cloths go with: an entry a cloth where the scene has any, or none.
struct Frames {
  std::vector<MovingFrame> at;                 // at the last frame's end
  std::vector<FrameMotion> motion;             // in the last frame
  std::vector<std::optional<MovingFrame>> pending;   // that the host has set since the last frame
  std::vector<bool> is_host_driven;
  std::vector<gpu::FrameChange> changes;       // of the frame at hand
};

/// What it takes to repeat a frame. While `frame_is_torn` the solver's buffers are in the middle of a frame, and `saved` holds its
/// start.
struct Rollback {
  std::vector<const Buffer*> rows;             // Lifetime::persistent: what a frame leaves to the next one, in the order of rows
  compute::Arena saved;                        // with contacts, or passes one by one: a copy of each
  std::uint32_t candidates = 0;                // number of candidates in it
  bool frame_is_torn = false;
};

/// Growth of the capacity for contact candidates: before it is needed or when it was, until the device has no more memory.
struct ContactCapacity {
  struct Outgrown {
    Solver::Outgrown buffers;
    bool is_copied = false;                    // by the frame `until`, or one of `record` after it
    std::uint64_t until = 0;
  };
  std::vector<Outgrown> outgrown;              // oldest first: the candidates of each go to the next, and the last one's to the solver's
  std::uint32_t room = 0, lost = 0, told = 0;  // Counters::contacts_room and contacts_overflowed as far as known; told to the host
  std::uint32_t load = 0;                      // Counters::contacts_load of the last frame that is known to be done
  std::uint32_t detections = 0, calm = 0, still = 0;   // until then; frames in a row with hardly any, and with none, of those heard of
  bool is_final = false;                       // the device had no memory for more: not asked for again
};

/// How the host learns that a frame of `record` is done, without waiting: it sets an event at its end, and leaves its report.
struct RecordedFrames {
  std::array<compute::OwnedEvent, 4> done;
  std::array<bool, 4> is_under_way{};
  std::array<std::uint64_t, 4> number{};       // of the frame that sets it
  std::uint64_t recorded = 0, heard = 0;       // the last frame's number; the last of those that were heard of
  std::size_t next = 0;                        // the place of the next frame, if it is free
};

/// What colliders were given, in the order of Bodies::order, then grabs, then mesh colliders; with reactions. All have their size from the
/// start, so that a frame that is heard of asks for no memory.
struct ReactionSums {
  std::vector<gpu::Reaction> heard;            // of the frame that Report is of
  std::vector<gpu::Reaction> known, told;      // as far as known; as the host was told
  double quantum = 1;                          // of the fabric as it was cooked first
  std::vector<Reaction> between, pulls;        // of each collider of the scene, and of each grab, as they were told
};

/// Frames that Weft submits. Frame n is done when `ready` has reached n or, on a device without timeline semaphores, when its slot's fence
/// is signalled; `waited` is the last that was waited for, `submitted` the last of all, `heard` the last that the host has the report of.
struct FrameQueue {
  compute::CommandPool pool;
  std::array<FrameSlot, 2> slots;
  compute::OwnedSemaphore ready;
  std::uint64_t submitted = 0, waited = 0, heard = 0;
  std::vector<DispatchTime> cpu_times;         // on devices without timestamps
  const FrameSlot* last_timed = nullptr;
};

struct Simulation::State {
  const compute::Device* device = nullptr;
  Scene described;                             // as the host gave it
  Scene scene;                                 // relative to the origin, as is everything below
  Vec3 origin;                                 // m, in the host's world
  SimulationOptions options;
  std::vector<Mesh> meshes;
  CookedFabric fabric;
  compute::PipelineCache cache;
  std::optional<Solver> solver;
  compute::Arena readback;       // what frames report: those of each slot, and then those of `record`
  bool has_recorded = false;     // a frame of `record` after the last report that was heard
  Report heard;                  // the last one; the host reads no memory that a frame under way may write
  std::optional<std::uint64_t> digest;   // of the scene and its fabric, for snapshots; made when first needed
  Vec3 gravity;
  AirState moving_air;           // where the scene has any
  Clock clock;
  KinematicTargets kinematic;
  Holds holds;
  Tears tears;
  Grabs grabs;
  Bodies bodies;
  Skins skins;
  Frames frames;
  std::vector<float> gas_amounts;   // of each cloth, as multiples of the scene's
  Rollback rollback;
  ContactCapacity capacity;
  FrameQueue queue;
  RecordedFrames recorded;
  ReactionSums reactions;

  double now() const { return static_cast<double>(clock.substeps) * fabric.h; }
  bool timed_on_cpu() const;
  double dispatches_of(double substeps) const;   // of a frame of so many substeps, at most
  Result<Advance> plan_frame(double seconds, FrameInput& input);
  /// As vertices of cloth meet a collider: larger than it is where triangles between them would show it through.
  gpu::BodySize size_to_vertices(std::uint32_t collider) const;
  void move_scene(double seconds, FrameInput& input);
  bool is_driven() const;
  void move_anchors();
  void move_grabs();
  std::size_t anchors_and_pins() const { return kinematic.pending.size(); }
  std::uint32_t held_by(std::size_t place) const;   // WEFT_NONE: nobody
  std::map<std::uint32_t, std::size_t> places_held() const;   // by the particle that is held there
  Result<std::vector<std::uint32_t>> particles_of(std::span<const std::uint32_t> vertices) const;
  Result<std::vector<std::uint32_t>> pinnable(std::span<const std::uint32_t> vertices) const;
  std::vector<bool> are_held(std::span<const gpu::Anchor> targets) const;
  Holds::Cooked cooked_for(std::span<const gpu::Anchor> targets);   // has the room that take() needs
  void take(Holds::Cooked cooked) noexcept;
  void follow_holds();
  // Tears.
  struct Torn {
    std::vector<Mesh> meshes;
    Holds::Cooked cooked;
    std::vector<std::uint32_t> applied;        // splits of each cloth
  };
  Result<void> make_tears();
  Result<void> follow_tears();
  Result<void> hear_look();
  void record_look(compute::Recorder& recorder);
  std::vector<std::vector<Split>> splits_in(std::span<const Vec3> places, const cooking::Blade* blade);
  std::uint32_t split_count() const;
  Result<std::optional<Torn>> torn_by(std::vector<Mesh> from, std::span<const std::vector<Split>> splits,
                                      std::span<const gpu::Anchor> targets, bool copies);
  Result<std::optional<Torn>> torn_of(const Snapshot& snapshot, std::span<const gpu::Anchor> targets);
  void take(Torn torn);
  void grabs_follow(const CookedFabric& torn);
  Result<std::uint32_t> tear(std::span<const std::vector<Split>> splits);
  Result<void> ready_to_cut();
  Result<std::uint32_t> tear_now(std::span<const std::vector<Split>> splits);
  void save_tears(Snapshot& snapshot) const;
  void put_tears_back(const Snapshot& snapshot);
  void add_changes(const CookedFabric& next, std::vector<Edit>& edits, bool whole_plan) const;
  Result<void> send_edits();
  bool are_targets(const std::vector<gpu::Anchor>& targets) const;
  static std::vector<gpu::vec4> positions_of(const CookedFabric& fabric, const std::vector<bool>& held);
  void frame_is_sent(const Advance& advance, std::uint64_t frame);
  Result<std::uint32_t> free_grab(const Grip& grip) const;
  Result<std::vector<Vec3>> places_of_particles();
  Grabbed take_hold(std::uint32_t grab, const Hit& hit, std::span<const Vec3> places, const Grip& grip);
  Result<ColliderPose> checked_pose(std::uint32_t collider, const ColliderPose& pose) const;
  const ColliderMesh* mesh_of(std::uint32_t collider) const;   // null: it is none
  Vec3 move_collider_on(std::uint32_t collider);
  void move_collider_meshes();
  void move_carried(std::span<const Affine> pose);
  std::span<const SkinnedMesh> skinned_meshes() const { return fabric.own.of<SkinLists>().meshes; }
  Result<void> check_skins(const Snapshot& snapshot) const;
  Result<void> check_gases(const Snapshot& snapshot) const;
  Skins skins_of(const Snapshot& snapshot) const;
  std::vector<Affine> next_pose() const;
  std::vector<float> next_weights() const;
  Result<std::vector<Vec3>> body_shape(const ColliderMesh& mesh);
  Result<void> carry_kept(bool is_collider, std::uint32_t index, const RigidMap& map);
  void choose_sources(FrameInput& input);
  void move_skins(std::span<const Affine> pose, std::span<const float> weights, std::span<const ColliderPose> before, FrameInput& input);
  MovingFrame frame_of_joint(std::size_t cloth, std::span<const Affine> pose) const;
  void move_frames(std::span<const Affine> pose, double seconds, FrameInput& input);
  Result<void> turn_kept(const ClothRange& range, const RigidMap& carry);
  Result<void> check_frames(const Snapshot& snapshot) const;
  std::vector<Snapshot::FrameState> saved_frames() const;
  void put_frames_back(const Snapshot& snapshot);
  Result<void> set_joints(bool is_collider, std::uint32_t index, std::span<const Affine> joints);
  Result<void> set_targets(bool is_collider, std::uint32_t index, const TargetBuffer& targets);
  Result<void> set_weights(bool is_collider, std::uint32_t index, std::span<const float> weights);
  void record_frame(VkCommandBuffer commands, const FrameInput& input, compute::Timestamps* timestamps, bool save, std::size_t place);
  Result<void> submit_frame(const FrameInput& input, std::span<const VkSemaphoreSubmitInfo> waits, bool save);
  Result<void> run_pass_by_pass(const FrameInput& input, bool save);
  Result<void> run_to_the_end(FrameInput input);
  Result<void> create_saved();
  void copy_saved(VkCommandBuffer commands, bool back) const;
  Result<void> put_frame_back();
  Result<bool> grow_capacity(std::uint64_t wanted);
  void make_room();
  void record_growth(compute::Recorder& recorder) const;
  void growth_is_recorded();
  Result<void> copy_outgrown();
  void let_go_of_outgrown(std::uint64_t frame);
  void learn(const gpu::Counters& counters);
  bool contacts_are_few() const;
  bool detections_are_seldom() const;
  void count_calm(const gpu::Counters& counters);
  bool is_still() const;
  bool contacts_may_leap() const;
  void hasten(std::uint32_t particle, Vec3 from, Vec3 to);
  float haste_after(const Advance& advance);
  void stir();
  void hear_recorded();
  std::uint32_t lost_since_told() { return capacity.lost - std::exchange(capacity.told, capacity.lost); }
  Result<gpu::Detection> detection_anew() const;
  /// What the next detection of contacts measures displacement bounds by (detect_track.comp); empty without contacts.
  struct Tracks {
    std::vector<gpu::vec4> at, trajectories;
    std::uint32_t lifetime = 0;
  };
  Result<Tracks> tracks();
  Result<void> put(const Tracks& tracks);
  std::size_t slot_of(std::uint64_t frame) const { return frame % queue.slots.size(); }
  std::size_t place_of_recorded() const { return queue.slots.size(); }
  std::size_t place_of_event(std::size_t event) const { return place_of_recorded() + 1 + event; }
  enum Part : std::size_t { kCounters, kDetection, kReactions };
  /// A part of the report at a place; reactions only where the scene has them.
  const compute::Buffer& readback_of(std::size_t place, Part part) const {
    return readback[(solver->has(buffers::reactions) ? 3 : 2) * place + part];
  }
  Report reported(std::size_t place) const;
  /// The place of the last frame that is done, while others are under way; none: the report of it has been heard.
  std::optional<std::size_t> newest_place() const;
  void read_reactions(std::size_t place, std::vector<gpu::Reaction>& into) const;
  void hear_reactions();
  void hear(std::uint64_t frame);
  Result<void> wait_for_frame(std::uint64_t frame);
  std::uint64_t last_done() const;
  Result<void> wait_for_slot();
  Result<void> draw_surface();
  std::uint64_t own_digest();
  Result<std::optional<Torn>> check(const Snapshot& snapshot);
  Result<void> put_back(const Snapshot& snapshot, std::optional<Torn> torn);
  Result<void> wait();
  Result<std::vector<gpu::vec4>> read(const Buffer& row, std::size_t count);
  Result<void> put(std::span<const gpu::vec4> positions);
  Result<void> write(std::vector<compute::Upload> uploads, const gpu::Counters& counted);
  Result<void> check_count(std::span<const gpu::vec4> values) const;
  Result<gpu::Counters> counters_and_sanitized(std::size_t more);
};

}  // namespace weft
