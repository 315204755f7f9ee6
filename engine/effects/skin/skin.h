// Skins: morph targets and joints carry particles along (linear blend skinning). They move anchors and mesh colliders, and the animated
// places that motion constraints keep to.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/collider_pose.h"
#include "engine/effects/buffer.h"
#include "engine/effects/motion_constraint/motion_constraint.h"
#include "engine/mesh.h"

namespace weft {

/// A cloth or a mesh collider that a skin moves.
struct SkinnedMesh {
  bool is_collider = false;
  std::uint32_t index = 0;          // of Scene::cloths or Scene::colliders
  std::uint32_t mesh = 0;           // of the list of meshes
  std::uint32_t animation = kNone;  // of the mesh's skin; kNone: none
  std::uint32_t first_joint = 0, joints = 0;
  std::uint32_t first_morph = 0, morphs = 0;   // of all morph targets
  std::uint32_t first_target = 0, targets = 0; // of host_targets, one a render vertex; 0: it takes none
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
  std::vector<float> first_weights;     // of all morph targets, when the scene begins
  std::vector<gpu::uvec2> morph_rows;   // of each point: its first delta, and how many; none where no point has any
  std::vector<gpu::MorphDelta> morph_deltas;
  std::vector<gpu::vec3> morph_normals; // of each delta: by which it changes the normal; none where no backstop asks for them
  std::uint32_t targets = 0;            // of all meshes that take them
  std::vector<gpu::uvec2> target_rows;  // of each point: its target, or WEFT_NONE, and its mesh; none where no mesh takes any
};

/// Whether the scene calls for the skin of a cloth: its targets, or what keeps to them.
inline bool is_skinned(const Cloth& cloth) { return cloth.skin || cloth.motion_constraints; }

/// Where a skinned mesh's joints are at `time` (s), by its animation: with none, and of a mesh without a skin, where they are at rest.
std::vector<Affine> joints_at(const Scene& scene, const SkinnedMesh& skinned, const Mesh& mesh, double time);

/// The same of the weights of its morph targets.
std::vector<float> weights_at(const Scene& scene, const SkinnedMesh& skinned, const Mesh& mesh, double time);

/// The map of what is turned by `rotation` and then put at `centre`.
Affine affine(Vec3 centre, const Rotation& rotation);

/// The rotation nearest to a joint's map, which may scale.
Rotation rotation_of(const Affine& joint);

/// Where a joint has a collider that it carries.
ColliderPose carried_pose(const Collider& collider, const Affine& joint);

/// Joints as the GPU has them, where the frame begins and where it ends.
gpu::Joint joint_between(const Affine& from, const Affine& to);

/// A point of the list as morph targets have it, before joints carry it. `weights`: of all morph targets of the scene.
gpu::SkinPoint morphed(const SkinLists& lists, std::size_t point, std::span<const float> weights);

/// m: where joints take a point of a skin, of all joints of the scene.
Vec3 skinned_point(const gpu::SkinPoint& point, std::span<const Affine> joints);

/// Adds the deltas of a mesh, whose points are those of the list from `first` on, in this order (point_order[k]: the mesh's point).
void add_deltas(const Mesh& mesh, const SkinnedMesh& skinned, std::span<const std::uint32_t> point_order, bool with_normals,
                SkinLists& lists);

/// The same of the targets of a mesh; `number`: of SkinLists::meshes.
void add_targets(const Mesh& mesh, const SkinnedMesh& skinned, std::uint32_t number, std::span<const std::uint32_t> point_order,
                 SkinLists& lists);

/// Leaves out points that `is_kept` refuses, with their deltas; and all that nothing reads then.
void keep(SkinLists& lists, bool (*is_kept)(const gpu::SkinPoint&));

namespace lengths {
inline std::uint64_t joints(const Cooked& s) { return s.fabric.own.of<SkinLists>().first_pose.size(); }
inline std::uint64_t morphs(const Cooked& s) { return s.fabric.own.of<SkinLists>().first_weights.size(); }
inline std::uint64_t host_targets(const Cooked& s) { return s.fabric.own.of<SkinLists>().targets; }
inline std::uint64_t skinned_meshes(const Cooked& s) { return s.fabric.own.of<SkinLists>().meshes.size(); }
inline std::uint64_t skin_points(const Cooked& s) { return s.fabric.own.of<SkinLists>().points.size(); }
/// With the normal of each where there are backstops.
inline std::uint64_t skin_ends(const Cooked& s) { return (has_backstops(s.scene) ? 2 : 1) * skin_points(s); }
}  // namespace lengths

namespace buffers {
inline constexpr Buffer skin_points = own<gpu::SkinPoint, &SkinLists::points>("skin_points");
/// Of the frame.
inline constexpr Buffer skin_joints = buffer<gpu::Joint>("skin_joints", Lifetime::uploaded, lengths::joints);
inline constexpr Buffer morph_rows = own<gpu::uvec2, &SkinLists::morph_rows>("morph_rows");
inline constexpr Buffer morph_deltas = own<gpu::MorphDelta, &SkinLists::morph_deltas>("morph_deltas");
inline constexpr Buffer morph_normals = own<gpu::vec3, &SkinLists::morph_normals>("morph_normals");
inline constexpr Buffer target_rows = own<gpu::uvec2, &SkinLists::target_rows>("target_rows");
/// Copied from the host's buffers: of each render vertex of the meshes that take targets where the frame ends (m, world space).
inline constexpr Buffer host_targets = buffer<gpu::vec4>("host_targets", Lifetime::uploaded, lengths::host_targets);
inline constexpr Buffer host_normals = buffer<gpu::vec4>("host_normals", Lifetime::uploaded, lengths::host_targets);
/// Of each skinned mesh, for the frame: WEFT_FROM_KEPT and the like.
inline constexpr Buffer skin_sources = buffer<gpu::uint>("skin_sources", Lifetime::uploaded, lengths::skinned_meshes);
/// Of points that the host's buffer has moved: where the last frame has ended (m).
inline constexpr Buffer skin_ends = buffer<gpu::vec4>("skin_ends", Lifetime::persistent, lengths::skin_ends);
/// Of the frame: where it begins, and where it ends.
inline constexpr Buffer morph_weights = buffer<gpu::vec2>("morph_weights", Lifetime::uploaded, lengths::morphs);
}  // namespace buffers

}  // namespace weft
