// Skins: joints carry particles along (linear blend skinning). They move anchors and mesh colliders, and the animated places that motion
// constraints keep to.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/collider_pose.h"
#include "engine/effects/buffer.h"
#include "engine/mesh.h"

namespace weft {

/// A cloth or a mesh collider that a skin moves.
struct SkinnedMesh {
  bool is_collider = false;
  std::uint32_t index = 0;          // of Scene::cloths or Scene::colliders
  std::uint32_t mesh = 0;           // of the list of meshes
  std::uint32_t animation = kNone;  // of the mesh's skin; kNone: none
  std::uint32_t first_joint = 0, joints = 0;
};

/// A collider that a joint carries.
struct BoundCollider {
  std::uint32_t collider = 0, joint = 0;   // of Scene::colliders; of all joints
};

struct SkinLists {
  std::vector<gpu::SkinPoint> points;   // that it holds or keeps near, in the order of their particles
  std::vector<SkinnedMesh> meshes;
  std::vector<Affine> first_pose;       // of all joints: where they are when the scene begins
  std::vector<BoundCollider> bones;
};

/// Whether the scene calls for the skin of a cloth: its targets, or what keeps to them.
inline bool is_skinned(const Cloth& cloth) { return cloth.skin || cloth.motion_constraints; }

/// Where a skinned mesh's joints are at `time` (s), by its animation: with none, and of a mesh without a skin, where they are at rest.
std::vector<Affine> joints_at(const Scene& scene, const SkinnedMesh& skinned, const Mesh& mesh, double time);

/// The map of what is turned by `rotation` and then put at `centre`.
Affine affine(Vec3 centre, const Rotation& rotation);

/// The rotation nearest to a joint's map, which may scale.
Rotation rotation_of(const Affine& joint);

/// Where a joint has a collider that it carries.
ColliderPose carried_pose(const Collider& collider, const Affine& joint);

/// Joints as the GPU has them, where the frame begins and where it ends.
gpu::Joint joint_between(const Affine& from, const Affine& to);

/// m: where joints take a point of a skin, of all joints of the scene.
Vec3 skinned_point(const gpu::SkinPoint& point, std::span<const Affine> joints);

namespace lengths {
inline std::uint64_t joints(const Cooked& s) { return s.fabric.own.of<SkinLists>().first_pose.size(); }
inline std::uint64_t skin_points(const Cooked& s) { return s.fabric.own.of<SkinLists>().points.size(); }
}  // namespace lengths

namespace buffers {
inline constexpr Buffer skin_points = own<gpu::SkinPoint, &SkinLists::points>("skin_points");
/// Of the frame.
inline constexpr Buffer skin_joints = buffer<gpu::Joint>("skin_joints", Lifetime::uploaded, lengths::joints);
}  // namespace buffers

}  // namespace weft
