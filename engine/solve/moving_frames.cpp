// The frames that cloths go with: where they are, and cloth that is set elsewhere with them.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/effects/bdf2/bdf2.h"
#include "engine/effects/support/support.h"
#include "engine/finite.h"
#include "engine/mesh/parts.h"
#include "engine/solve/state.h"

namespace weft {
namespace {

using Eigen::Vector3d;

using parts::narrow;
using parts::wide;

Result<MovingFrame> checked(const MovingFrame& frame) {
  const Rotation& r = frame.rotation;
  const float squared = r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w;
  if (!is_finite(frame.place)) return fail("its place is not finite, or ", kTooLarge, " m away or more");
  if (!(squared > 1e-12f && squared < 1e12f)) return fail("its rotation has no length, or is not finite");
  return MovingFrame{frame.place, narrow(wide(r))};
}

}  // namespace

MovingFrame Simulation::State::frame_of_joint(std::size_t cloth, std::span<const Affine> pose) const {
  const auto& lists = fabric.own.of<InertiaLists>();
  const Affine& joint = pose[lists.joints[cloth]];
  return {joint * lists.places[cloth], rotation_of(joint)};
}

// `pose`: of all joints, where this frame of `seconds` ends.
void Simulation::State::move_frames(std::span<const Affine> pose, double seconds, FrameInput& input) {
  const auto& joints = fabric.own.of<InertiaLists>().joints;
  for (std::size_t k = 0; k < frames.at.size(); ++k) {
    if (!scene.cloths[k].inertia) continue;
    MovingFrame to = frames.at[k];
    if (frames.pending[k]) to = *frames.pending[k];
    else if (!frames.is_host_driven[k] && joints[k] != kNone) to = frame_of_joint(k, pose);
    const FrameMotion next = motion_between(frames.at[k], to, seconds);
    frames.changes[k] = change_of(*scene.cloths[k].inertia, frames.at[k], frames.motion[k], next);
    frames.at[k] = to;
    frames.motion[k] = next;
    frames.pending[k].reset();
  }
  input.frame_changes = frames.changes;
}

Result<void> Simulation::move_frame(std::uint32_t cloth, const MovingFrame& frame) try {
  State& s = *state_;
  if (cloth >= s.scene.cloths.size() || !s.scene.cloths[cloth].inertia)
    return fail("cloth ", cloth, " has no frame to go with: there is none, or the scene does not ask for one (its key \"inertia\")");
  auto good = checked(frame);
  if (!good) return fail("the frame of cloth ", cloth, ": ", good.why());
  good->place = good->place - s.origin;
  const bool is_first = !s.frames.is_host_driven[cloth] && s.fabric.own.of<InertiaLists>().joints[cloth] == kNone;
  if (is_first) s.frames.at[cloth] = *good;   // the host tells where it is: that is no motion
  else s.frames.pending[cloth] = *good;
  s.frames.is_host_driven[cloth] = true;
  return {};
} catch (...) {
  return caught("the frame");
}

// What particles keep from substep to substep turns with their cloth: what colliders hold, and what is kept of the last substep, but for
// the part that gravity has in it (shaders/bdf2/bdf2.glsl).
Result<void> Simulation::State::turn_kept(const ClothRange& range, const RigidMap& carry) {
  for (const Buffer* row : {&buffers::supports, &buffers::velocity_changes, &buffers::step_remainders}) {
    if (!solver->has(*row)) continue;
    const auto h = static_cast<float>(fabric.h);
    const Vec3 fall = row == &buffers::velocity_changes ? h * gravity : row == &buffers::step_remainders ? -0.5f * h * h * gravity : Vec3{};
    auto kept = read(*row, fabric.positions.size());
    if (!kept) return kept.take_error();
    for (std::uint32_t i = range.first_particle; i < range.first_particle + range.particles; ++i) {
      gpu::vec4& one = (*kept)[i];
      const Vec3 way = carry.way(Vec3{one.x, one.y, one.z} - fall) + fall;
      one = {way.x, way.y, way.z, one.w};
    }
    if (auto done = compute::upload(*device, solver->buffer(*row), std::as_bytes(std::span(*kept))); !done) return done;
  }
  return {};
}

Result<void> Simulation::teleport(std::uint32_t cloth, const MovingFrame& from, const MovingFrame& to) try {
  State& s = *state_;
  if (cloth >= s.fabric.cloths.size()) return fail("there is no cloth ", cloth, ", the scene has ", s.fabric.cloths.size());
  const auto old_frame = checked(from), new_frame = checked(to);
  if (!old_frame) return fail("the frame that cloth ", cloth, " leaves: ", old_frame.why());
  if (!new_frame) return fail("the frame that cloth ", cloth, " is taken to: ", new_frame.why());
  const RigidMap carry{wide(new_frame->rotation) * wide(old_frame->rotation).conjugate(), wide(old_frame->place) - wide(s.origin),
                    wide(new_frame->place) - wide(s.origin)};
  const ClothRange& range = s.fabric.cloths[cloth];
  const auto is_own = [&](std::uint32_t particle) { return particle - range.first_particle < range.particles; };
  auto positions = read_positions(), velocities = read_velocities();
  if (!positions) return positions.take_error();
  if (!velocities) return velocities.take_error();
  for (std::uint32_t i = range.first_particle; i < range.first_particle + range.particles; ++i) {
    gpu::vec4 &x = (*positions)[i], &v = (*velocities)[i];
    const Vec3 place = carry.place({x.x, x.y, x.z}), way = carry.way({v.x, v.y, v.z});
    if (!is_finite(place)) return fail("cloth ", cloth, " would be ", kTooLarge, " m away or more");
    x = {place.x, place.y, place.z, x.w};
    v = {way.x, way.y, way.z, v.w};
  }
  auto tracks = s.tracks();
  if (!tracks) return tracks.take_error();
  for (std::uint32_t i = range.first_particle; i < range.first_particle + range.particles && !tracks->at.empty(); ++i) {
    gpu::vec4 &at = tracks->at[i], &trajectory = tracks->trajectories[i];
    const Vec3 place = carry.place({at.x, at.y, at.z}), way = carry.way({trajectory.x, trajectory.y, trajectory.z});
    at = {place.x, place.y, place.z, at.w};
    trajectory = {way.x, way.y, way.z, trajectory.w};
  }
  // put() makes written positions the targets, too. Anchors that cloth holds back keep theirs, and those that stay where they are, wherever
  // that is, are there now.
  const std::vector<gpu::Anchor> targets = s.kinematic.targets;
  if (auto done = s.put(*positions); !done) return done;
  if (auto done = write_velocities(*velocities); !done) return done;
  if (auto done = s.put(*tracks); !done) return done;
  if (auto done = s.turn_kept(range, carry); !done) return done;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    if (targets[k].particle == WEFT_NONE) continue;
    gpu::Anchor& anchor = s.kinematic.targets[k];
    if (!is_own(targets[k].particle & ~(WEFT_STAYS | WEFT_FROM_HERE))) {
      anchor.particle = targets[k].particle;
      anchor.to = targets[k].to;
    } else if ((targets[k].particle & WEFT_STAYS) == 0) {
      const Vec3 there = carry.place({targets[k].to.x, targets[k].to.y, targets[k].to.z});
      anchor.to = {there.x, there.y, there.z};
    }
  }
  for (const SkinnedMesh& skinned : s.skinned_meshes()) {
    if (skinned.is_collider || skinned.index != cloth) continue;
    for (std::uint32_t k = skinned.first_joint; k < skinned.first_joint + skinned.joints; ++k) {
      Affine& joint = s.skins.pose[k];
      joint = {carry.way(joint.x), carry.way(joint.y), carry.way(joint.z), carry.place(joint.origin)};
    }
  }
  if (auto done = s.carry_kept(false, cloth, carry); !done) return done;
  for (const auto& [collider, joint] : s.fabric.own.of<SkinLists>().bones)   // those of other cloths are where they were
    s.bodies.poses[collider] = carried_pose(s.scene.colliders[collider], s.skins.pose[joint]);
  if (s.scene.cloths[cloth].inertia) {
    MovingFrame& frame = s.frames.at[cloth];
    FrameMotion& motion = s.frames.motion[cloth];
    frame = {carry.place(frame.place), narrow(carry.turn * wide(frame.rotation))};
    const Vector3d velocity = carry.turn * Vector3d(motion.velocity[0], motion.velocity[1], motion.velocity[2]);
    motion.velocity = {velocity.x(), velocity.y(), velocity.z()};
    motion.turn = narrow(carry.turn * wide(motion.turn) * carry.turn.conjugate());
  }
  return s.draw_surface();
} catch (...) {
  return caught("the cloth");
}

// Errors: what is damaged.
Result<void> Simulation::State::check_frames(const Snapshot& snapshot) const {
  if (snapshot.frames.size() != frames.at.size())
    return fail("it has frames of ", snapshot.frames.size(), " cloths instead of ", frames.at.size());
  for (const Snapshot::FrameState& state : snapshot.frames) {
    const bool sound = checked(state.at) && checked(state.pending) && checked({{}, state.turn}) && state.seconds > 0 &&
                       std::isfinite(state.seconds) && std::ranges::all_of(state.velocity, [](double v) { return std::abs(v) < 1e30; });
    if (!sound) return fail("the frame of a cloth is not finite");
  }
  return {};
}

std::vector<Snapshot::FrameState> Simulation::State::saved_frames() const {
  std::vector<Snapshot::FrameState> saved;
  for (std::size_t k = 0; k < frames.at.size(); ++k)
    saved.push_back({frames.is_host_driven[k], frames.pending[k].has_value(), frames.at[k], frames.pending[k].value_or(MovingFrame{}),
                     frames.motion[k].velocity, frames.motion[k].turn, frames.motion[k].seconds});
  return saved;
}

// As a snapshot that was checked has them.
void Simulation::State::put_frames_back(const Snapshot& snapshot) {
  for (std::size_t k = 0; k < frames.at.size(); ++k) {
    const Snapshot::FrameState& state = snapshot.frames[k];
    frames.is_host_driven[k] = state.is_host_driven;
    frames.at[k] = state.at;
    frames.pending[k] = state.is_pending ? std::optional(state.pending) : std::nullopt;
    frames.motion[k] = {state.velocity, state.turn, state.seconds};
  }
}

}  // namespace weft
