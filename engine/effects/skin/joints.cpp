// Where joints are, for the passes and for the host.
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

#include "engine/effects/skin/skin.h"
#include "engine/mesh/parts.h"

namespace weft {

namespace {

// s: how far into its animation a mesh is.
double into_animation(const Scene& scene, const SkinnedMesh& skinned, const Mesh& mesh, double time) {
  const auto& described = skinned.is_collider ? scene.colliders[skinned.index].skin : scene.cloths[skinned.index].skin;
  const Skinning skinning = described.value_or(Skinning{});
  const double length = duration_of(mesh.skin->animations[skinned.animation]), into = skinning.start + skinning.speed * time;
  return skinning.loops && length > 0 ? std::fmod(into, length) : into;
}

}  // namespace

std::vector<Affine> joints_at(const Scene& scene, const SkinnedMesh& skinned, const Mesh& mesh, double time) {
  if (skinned.animation == kNone || mesh.skin->joints.empty()) return std::vector<Affine>(skinned.joints);
  return joints_at(*mesh.skin, skinned.animation, into_animation(scene, skinned, mesh, time));
}

std::vector<float> weights_at(const Scene& scene, const SkinnedMesh& skinned, const Mesh& mesh, double time) {
  if (skinned.morphs == 0) return {};
  const double into = skinned.animation == kNone ? 0 : into_animation(scene, skinned, mesh, time);
  return weights_at(*mesh.skin, skinned.animation, into);
}

Affine affine(Vec3 centre, const Rotation& rotation) {
  return {rotated(rotation, {1, 0, 0}), rotated(rotation, {0, 1, 0}), rotated(rotation, {0, 0, 1}), centre};
}

Rotation rotation_of(const Affine& joint) {
  return parts::narrow(Eigen::Quaterniond(parts::wide(joint).rotation()).normalized());
}

ColliderPose carried_pose(const Collider& collider, const Affine& joint) {
  const Rotation turn = rotation_of(joint);
  return {joint * collider.centre, rotated(turn, collider.normal), turn * rest_rotation(collider)};
}

gpu::Joint joint_between(const Affine& from, const Affine& to) {
  const auto row = [](const Affine& m, float Vec3::*axis) { return gpu::vec4{m.x.*axis, m.y.*axis, m.z.*axis, m.origin.*axis}; };
  return {{row(from, &Vec3::x), row(from, &Vec3::y), row(from, &Vec3::z)}, {row(to, &Vec3::x), row(to, &Vec3::y), row(to, &Vec3::z)}};
}

Vec3 skinned_point(const gpu::SkinPoint& point, std::span<const Affine> joints) {
  const std::uint32_t of[] = {point.joints.x & 0xffff, point.joints.x >> 16, point.joints.y & 0xffff, point.joints.y >> 16};
  const float weights[] = {point.weights.x, point.weights.y, point.weights.z, point.weights.w};
  Vec3 place;
  for (std::size_t k = 0; k < Skin::kInfluences; ++k)
    place = place + weights[k] * (joints[of[k]] * Vec3{point.rest.x, point.rest.y, point.rest.z});
  return place;
}

}  // namespace weft
