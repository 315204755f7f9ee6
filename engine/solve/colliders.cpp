// Colliders as the host moves, places and resizes them.
#include <cmath>

#include "engine/effects/ranges.h"
#include "engine/finite.h"
#include "engine/solve/state.h"

namespace weft {
namespace {

constexpr float kUnitRounding = 5e-7f;   // of a length of floats near 1: four of their steps, for four squares and a root

}  // namespace

Result<ColliderPose> Simulation::State::checked_pose(std::uint32_t collider, const ColliderPose& pose) const {
  if (collider >= bodies.poses.size()) return fail("collider ", collider, " is not below the scene's ", bodies.poses.size());
  const Rotation& r = pose.rotation;
  const float norm = std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w);
  if (!is_finite(pose.centre) || !is_finite(pose.normal) || !std::isfinite(norm))
    return fail("the pose of collider ", collider, " is not finite, or ", kTooLarge, " m away or more");
  if (!(norm > 1e-6f)) return fail("the rotation of collider ", collider, " is a quaternion of length ", norm, ", not above 1e-6");
  ColliderPose checked = pose;
  checked.centre = checked.centre - origin;
  // One of length 1 up to the rounding of floats stays as it is, so that a host can do to the bit what a scene's keys do.
  if (!(std::abs(norm - 1) < kUnitRounding)) checked.rotation = {r.x / norm, r.y / norm, r.z / norm, r.w / norm};
  if (scene.colliders[collider].shape == ColliderShape::plane) {   // other shapes ignore it
    const float size = length(pose.normal);
    if (!(size > 1e-6f)) return fail("the normal of collider ", collider, " has a length of ", size, ", not above 1e-6");
    if (!(std::abs(size - 1) < kUnitRounding)) checked.normal = (1 / size) * pose.normal;
  }
  return checked;
}

Result<void> Simulation::move_collider(std::uint32_t collider, const ColliderPose& pose) {
  return move_colliders(collider, std::span(&pose, 1));
}

// All of them or none.
Result<void> Simulation::move_colliders(std::uint32_t first, std::span<const ColliderPose> poses) try {
  const std::size_t colliders = state_->bodies.poses.size();
  if (first > colliders || poses.size() > colliders - first)
    return fail("colliders ", first, " to ", first + poses.size(), " (exclusive) are beyond the simulation's ", colliders);
  for (const auto& [collider, joint] : state_->fabric.own.of<SkinLists>().bones)
    if (collider >= first && collider - first < poses.size())
      return fail("collider ", collider, " goes with a joint of the cloth \"", state_->scene.colliders[collider].bone->cloth,
                  "\": set_pose, or the animation, moves it");
  std::vector<ColliderPose> checked;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    auto pose = state_->checked_pose(static_cast<std::uint32_t>(first + k), poses[k]);
    if (!pose) return pose.take_error();
    checked.push_back(*pose);
  }
  for (std::size_t k = 0; k < checked.size(); ++k) {
    state_->bodies.pending[first + k] = checked[k];
    state_->bodies.is_host_driven[first + k] = true;
  }
  return {};
} catch (...) {
  return caught("the colliders");
}

Result<void> Simulation::place_collider(std::uint32_t collider, const ColliderPose& pose) try {
  const auto there = state_->checked_pose(collider, pose);
  if (!there) return fail(there.why());
  if (const ColliderMesh* mesh = state_->mesh_of(collider)) {
    auto positions = read_positions();
    if (!positions) return positions.take_error();
    const auto shape = state_->body_shape(*mesh);
    if (!shape) return shape.why();
    for (std::uint32_t k = 0; k < mesh->particles; ++k) {
      const Vec3 at = there->centre + rotated(there->rotation, (*shape)[k]);
      (*positions)[mesh->first_particle + k] = {at.x, at.y, at.z, 0};
    }
    // put() makes written positions the targets, too. Anchors that cloth holds back must keep theirs.
    const std::vector<gpu::Anchor> before = state_->kinematic.targets;
    if (auto done = state_->put(*positions); !done) return done;
    for (std::size_t k = 0; k < before.size(); ++k) {
      const bool own = before[k].particle >= mesh->first_particle && before[k].particle - mesh->first_particle < mesh->particles;
      if (!own) state_->kinematic.targets[k].particle = before[k].particle, state_->kinematic.targets[k].to = before[k].to;
    }
    const ColliderPose& from = state_->bodies.poses[collider];
    const RigidMap way{parts::wide(there->rotation) * parts::wide(from.rotation).conjugate(), parts::wide(from.centre),
                       parts::wide(there->centre)};
    if (auto done = state_->carry_kept(true, collider, way); !done) return done;
  }
  state_->bodies.poses[collider] = *there;
  state_->bodies.pending[collider].reset();
  return state_->mesh_of(collider) != nullptr ? state_->draw_surface() : Result<void>();
} catch (...) {
  return caught("the collider");
}

Result<void> Simulation::resize_collider(std::uint32_t collider, const ColliderSize& size) try {
  if (collider >= state_->bodies.sizes.size()) return fail("collider ", collider, " is not below the scene's ", state_->bodies.sizes.size());
  const Collider& described = state_->scene.colliders[collider];
  if (!may_resize(described))
    return fail("collider ", collider, " may not be resized: it is a plane or a mesh, or the scene does not ask for it (its key \"resizes\")");
  const auto look = [&](const char* what, double value) -> Result<void> {
    if (value > 0 && value <= scene_fields::kFarthest) return {};
    return fail("the ", what, " of collider ", collider, " is ", value, " m, not above 0 and at most ", scene_fields::kFarthest, " m");
  };
  const bool box = described.shape == ColliderShape::box, capsule = described.shape == ColliderShape::capsule;
  ColliderSize taken = state_->bodies.sizes[collider];   // what the shape does not have stays
  if (box)
    for (const float side : {size.size.x, size.size.y, size.size.z})
      if (auto good = look("size", side); !good) return good;
  if (!box)
    if (auto good = look("radius", size.radius); !good) return good;
  if (capsule) {
    if (auto good = look("radius_end", size.radius_end); !good) return good;
    if (auto good = look("length", size.length); !good) return good;
  }
  if (box) taken.size = size.size;
  if (!box) taken.radius = taken.radius_end = size.radius;
  if (capsule) taken.radius_end = size.radius_end, taken.length = size.length;
  state_->bodies.pending_sizes[collider] = taken;
  return {};
} catch (...) {
  return caught("the collider");
}

std::span<const ColliderPose> Simulation::colliders() const {
  state_->bodies.in_world = state_->bodies.poses;
  for (ColliderPose& pose : state_->bodies.in_world) pose.centre = pose.centre + state_->origin;
  return state_->bodies.in_world;
}
std::span<const ColliderSize> Simulation::collider_sizes() const { return state_->bodies.sizes; }

}  // namespace weft
