// The whole state of a simulation between two frames, as values and as bytes: Simulation::save makes one, Simulation::restore takes
// it, and what follows is bitwise the same as if nothing had happened in between, in another process too.
//
//     weft::save_snapshot("now.snapshot", *simulation->save());
//     simulation->restore(*weft::load_snapshot("now.snapshot"));
//
// A snapshot holds what a frame changes and the next one needs, and nothing that is made anew from the scene. It fits only the
// scene and the meshes it was taken of, and carries their digest. It can be restored on another device; what follows there differs
// in its bits, as results of different devices do.
//
// A file, little-endian and without padding:
//
//     "WEFTSNAP"   version, 4 bytes   length of all of it, 8 bytes   the members below in their order   digest of all that, 8 bytes
//
// where a list is its length (8 bytes) and its elements. Files of other versions are refused, not translated.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "compute/result.h"
#include "engine/collider_pose.h"
#include "engine/fabric.h"
#include "engine/moving_frame.h"
#include "engine/scene.h"

namespace weft {

struct Snapshot {
  /// An anchor that the host drives, or a pin.
  struct AnchorTargetState {
    std::uint32_t anchor = 0;   // in CookedFabric::anchors' order; pins come after them
    bool is_pending = false;    // `target` is for the next frame
    Vec3 target;                // m
  };
  struct ColliderState {
    bool is_host_driven = false;   // instead of by keys
    bool is_pending = false;       // `pending` is for the next frame
    ColliderPose pose, pending;
    bool is_resized = false;       // `pending_size` is for the next frame
    ColliderSize size, pending_size;
  };
  struct SkinState {
    bool is_host_driven = false;
    std::vector<Affine> pose, pending;   // joints; pending: for the next frame, or empty
    bool has_host_weights = false;
    std::vector<float> weights, pending_weights;   // of morph targets; pending: as above
    bool is_kept = false;                // its points are where a buffer of the host's had them: `skin_ends` of `contents`
  };
  /// The frame that a cloth goes with.
  struct FrameState {
    bool is_host_driven = false;
    bool is_pending = false;       // `pending` is for the next frame
    MovingFrame at, pending;
    std::array<double, 3> velocity{};   // m/s: what it did in the last frame
    Rotation turn;
    double seconds = 1;
  };
  struct MotionLimitsState {
    float scale = 1, stiffness = 1;
  };
  struct AirFieldState {
    Vec3 centre, velocity;         // m, m/s
  };
  /// A place of cloth that a hand pulls at, as a triangle's corners share it.
  struct GrabState {
    std::uint32_t grab = 0;
    bool is_pending = false;       // `pending` is for the next frame
    Vec3 place, pending;           // m: the target
    float stiffness = 0, damping = 0, force = 0;   // N/m, N s/m, N
    std::array<std::uint32_t, 3> particles{};
    std::array<float, 3> weights{};
    std::array<Vec3, 3> offsets{}; // m: of each corner's target
  };
  /// A point of a cloth that has become two, or will where the next look is due.
  struct SplitState {
    std::uint32_t cloth = 0;
    bool is_found = false;
    std::uint32_t point = 0;
    std::vector<std::uint32_t> corners;
  };
  /// A buffer of the GPU, from its start on.
  struct Content {
    std::string name;           // as shared.h has it
    std::vector<std::byte> bytes;
  };

  std::uint64_t digest = 0;      // digest_of the scene and its fabric
  std::uint64_t substeps = 0;    // so far: the clock
  double left_over = 0;          // s, less than a substep: for the next frame
  Vec3 gravity;                  // m/s^2
  float haste = 0;               // of anchors, which sweeps of links follow
  Vec3 wind;                     // m/s
  std::vector<AirFieldState> air_fields;
  std::array<double, 3> wind_travelled{};   // m: its way since the start
  std::vector<SkinState> skins;
  std::vector<MotionLimitsState> motion_limits;   // of each cloth
  std::vector<FrameState> frames;   // of each cloth, where any has one
  std::vector<float> gas_amounts;   // of each cloth, as multiples of the scene's
  std::uint32_t phase = 0;       // substeps modulo 3, as the solver counts them
  std::uint32_t capacity = 0;    // of candidate pairs; 0 without contacts
  std::vector<AnchorTargetState> anchors;
  std::vector<GrabState> grabs;
  std::vector<ColliderState> colliders;   // of every collider of the scene
  std::vector<SplitState> splits;   // cloth after cloth, in the order in which they tore
  std::uint64_t tear_frames = 0;    // frames so far, by which looks are due
  std::uint32_t splits_refused = 0;
  std::vector<Content> contents;
  std::vector<std::byte> note;   // the host's own bytes, given back unchanged: how far its run was, say
};

/// Of everything in a scene and its fabric that the simulation depends on: not of names, frames, camera, light and appearance.
std::uint64_t digest_of(const Scene& scene, const CookedFabric& fabric);

std::vector<std::byte> snapshot_bytes(const Snapshot& snapshot);

/// Errors: bytes that are no snapshot, of another version, cut, longer than they say, or damaged. Allocates no more than a small
/// multiple of what it is given. Whether the snapshot fits a simulation is checked by restore.
Result<Snapshot> parse_snapshot(std::span<const std::byte> bytes);

/// Whole or not at all: under a temporary name in the same folder, then renamed. Errors: the system's reason, as write_file's
/// (compute/file.h): no such folder, no permission, a full disk, a target that is no regular file.
Result<void> save_snapshot(const std::filesystem::path& file, const Snapshot& snapshot);
/// Errors: as parse_snapshot; a file that cannot be read. Reads no more than the beginning of what is no snapshot.
Result<Snapshot> load_snapshot(const std::filesystem::path& file);

}  // namespace weft
