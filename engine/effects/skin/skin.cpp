// Which particles skins move, and where they are when the scene begins.
#include "engine/effects/skin/skin.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/cook/cook_state.h"
#include "engine/effects/anchor/anchor.h"
#include "engine/effects/effect.h"

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::skin_points,  &buffers::skin_joints,   &buffers::morph_rows,
                                      &buffers::morph_deltas, &buffers::morph_normals, &buffers::morph_weights,
                                      &buffers::target_rows,  &buffers::host_targets,  &buffers::host_normals,
                                      &buffers::skin_sources, &buffers::skin_ends};

constexpr Pass kPasses[] = {
    {.name = "skin", .stage = Stage::frame_begin, .threads = {lengths::skin_points}},
};

constexpr std::size_t kMostJoints = 65536;   // of a scene: a point has 16 bits for each

bool has_joints(const Mesh& mesh) { return mesh.skin && !mesh.skin->joints.empty(); }

std::string in_quotes(std::string_view name) { return '"' + std::string(name) + '"'; }

Result<std::uint32_t> chosen_animation(const Skinning& skinning, const Mesh& mesh) {
  const std::size_t count = mesh.skin ? mesh.skin->animations.size() : 0;
  if (skinning.animation.empty()) return count > 0 ? 0 : kNone;
  std::string names;
  for (std::uint32_t k = 0; k < count; ++k) {
    if (mesh.skin->animations[k].name == skinning.animation) return k;
    names += (k == 0 ? "" : ", ") + in_quotes(mesh.skin->animations[k].name);
  }
  return fail("skin.animation: the mesh has no ", in_quotes(skinning.animation), "; its animations are: ", names.empty() ? "none" : names);
}

// Adds the joints and morph targets of a mesh. Errors: an animation that it does not have; more joints than a scene may have.
Result<SkinnedMesh> add_joints(SkinnedMesh skinned, const Scene& scene, const Skinning& skinning, const Mesh& mesh, SkinLists& lists) {
  if (!mesh.skin_fault.empty()) return fail("skin: that of the mesh was left out: ", mesh.skin_fault);
  auto animation = chosen_animation(skinning, mesh);
  if (!animation) return animation.take_error();
  skinned.animation = *animation;
  skinned.first_joint = static_cast<std::uint32_t>(lists.first_pose.size());
  skinned.joints = has_joints(mesh) ? static_cast<std::uint32_t>(mesh.skin->joints.size()) : 1;
  skinned.first_morph = static_cast<std::uint32_t>(lists.first_weights.size());
  skinned.morphs = mesh.skin ? static_cast<std::uint32_t>(mesh.skin->morphs.size()) : 0;
  if (lists.first_pose.size() + skinned.joints > kMostJoints)
    return fail("skin: the scene's ", lists.first_pose.size() + skinned.joints, " joints up to here are more than ", kMostJoints);
  const std::vector<Affine> pose = joints_at(scene, skinned, mesh, 0);
  lists.first_pose.insert(lists.first_pose.end(), pose.begin(), pose.end());
  const std::vector<float> weights = weights_at(scene, skinned, mesh, 0);
  lists.first_weights.insert(lists.first_weights.end(), weights.begin(), weights.end());
  if (skinning.takes_targets) {
    skinned.first_target = lists.targets;
    skinned.targets = static_cast<std::uint32_t>(mesh.render.positions.size());
    lists.targets += skinned.targets;
  }
  lists.meshes.push_back(skinned);
  return skinned;
}

// The colliders that joints of this cloth carry.
Result<void> bind_colliders(const Scene& scene, const Cloth& cloth, const SkinnedMesh& skinned, const Mesh& mesh, SkinLists& lists) {
  const auto first = std::ranges::find(scene.cloths, cloth.name, &Cloth::name);
  if (&*first != &cloth) return {};
  for (std::uint32_t k = 0; k < scene.colliders.size(); ++k) {
    const Collider& collider = scene.colliders[k];
    if (!collider.bone || collider.shape == ColliderShape::mesh || collider.bone->cloth != cloth.name) continue;
    std::uint32_t joint = 0;
    std::string names;
    if (const std::string& wanted = collider.bone->joint; !wanted.empty()) {
      for (joint = 0; joint < skinned.joints; ++joint) {
        const std::string name = has_joints(mesh) ? mesh.skin->joints[joint].name : "";
        if (name == wanted) break;
        names += (joint == 0 ? "" : ", ") + in_quotes(name);
      }
      if (joint == skinned.joints)
        return fail("skin: it has no joint ", in_quotes(wanted), ", which colliders[", k, "].bone.joint asks for; its joints are: ", names);
    }
    lists.bones.push_back({k, skinned.first_joint + joint});
  }
  return {};
}

gpu::SkinPoint point_of(const Mesh& mesh, const SkinnedMesh& skinned, std::uint32_t p, std::uint32_t particle, Vec3 normal) {
  gpu::SkinPoint point{};
  point.particle = particle;
  point.anchor = point.cloth = WEFT_NONE;
  std::uint32_t joints[Skin::kInfluences] = {};
  float weights[Skin::kInfluences] = {1};
  if (has_joints(mesh))
    for (std::size_t k = 0; k < Skin::kInfluences; ++k) joints[k] = mesh.skin->joints_of[p][k], weights[k] = mesh.skin->weights[p][k];
  for (std::uint32_t& joint : joints) joint += skinned.first_joint;
  point.joints = {joints[0] | joints[1] << 16, joints[2] | joints[3] << 16};
  const float sum = weights[0] + weights[1] + weights[2] + weights[3];   // of rounded weights: nearly 1
  point.weights = {weights[0] / sum, weights[1] / sum, weights[2] / sum, weights[3] / sum};
  point.rest = {mesh.points[p].x, mesh.points[p].y, mesh.points[p].z};
  point.normal = {normal.x, normal.y, normal.z};
  return point;
}

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  if (!is_skinned(input.cloth)) return {};
  CookedFabric& fabric = state.fabric();
  const auto index = static_cast<std::uint32_t>(fabric.cloths.size() - 1);
  const Mesh& mesh = input.mesh;
  auto& lists = fabric.own.of<SkinLists>();
  const auto skinned = add_joints({.index = index, .mesh = index}, state.scene(), input.cloth.skin.value_or(Skinning{}), mesh, lists);
  if (!skinned) return skinned.why();
  if (auto bound = bind_colliders(state.scene(), input.cloth, *skinned, mesh, lists); !bound) return bound;
  const auto normals = smooth_normals(mesh.points, mesh.triangles);
  const ClothRange& range = fabric.cloths.back();
  std::vector<gpu::SkinPoint> points(range.particles);
  const auto place = [&](std::uint32_t p) { return state.particle_of()[p] - range.first_particle; };
  std::vector<std::uint32_t> order(range.particles);
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
    points[place(p)] = point_of(mesh, *skinned, p, state.particle_of()[p], normals[p]);
    order[place(p)] = p;
  }
  const bool stops = input.cloth.motion_constraints && input.cloth.motion_constraints->backstop_radius > 0;
  add_deltas(mesh, *skinned, order, stops, lists);
  add_targets(mesh, *skinned, static_cast<std::uint32_t>(lists.meshes.size() - 1), order, lists);
  if (const auto& constraints = input.cloth.motion_constraints) {
    const auto distances = cooking::mapped("motion_constraints.max_distance_map", constraints->max_distance_map, mesh);
    if (!distances) return distances.why();
    const auto stiffness = cooking::mapped("motion_constraints.stiffness_map", constraints->stiffness_map, mesh);
    if (!stiffness) return stiffness.why();
    const auto backstops = cooking::mapped("motion_constraints.backstop_map", constraints->backstop_map, mesh);
    if (!backstops) return backstops.why();
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
      gpu::SkinPoint& point = points[place(p)];
      point.cloth = index;
      point.max_distance = static_cast<float>(constraints->max_distance * cooking::factor(*distances, p));
      point.stiffness = static_cast<float>(std::min(1.0, cooking::factor(*stiffness, p)));
      point.backstop_distance = static_cast<float>(constraints->backstop_distance * cooking::factor(*backstops, p));
      point.backstop_radius = static_cast<float>(constraints->backstop_radius);
    }
  }
  const std::size_t first = fabric.anchors.size() - input.anchors.size();
  for (std::size_t k = 0; k < input.anchors.size(); ++k)   // those that keys do not drive go with the skin
    if (input.cloth.anchors[input.anchors[k].entry].keys.empty())
      points[place(input.anchors[k].point)].anchor = static_cast<std::uint32_t>(first + k);
  lists.points.insert(lists.points.end(), points.begin(), points.end());
  return {};
}

Result<void> cook_bodies(cooking::CookState& state, std::span<const Mesh> collider_meshes) {
  const Scene& scene = state.scene();
  CookedFabric& fabric = state.fabric();
  auto anchor = static_cast<std::uint32_t>(fabric.anchors.size()) + scene.pins;   // kinematic particles: anchors, pins, then these
  for (std::size_t m = 0; m < fabric.collider_meshes.size(); ++m) {
    const ColliderMesh& body = fabric.collider_meshes[m];
    if (const auto& skinning = scene.colliders[body.collider].skin) {
      const Mesh& mesh = collider_meshes[m];
      auto& lists = fabric.own.of<SkinLists>();
      const SkinnedMesh described{.is_collider = true, .index = body.collider, .mesh = static_cast<std::uint32_t>(scene.cloths.size() + m)};
      const auto skinned = add_joints(described, scene, *skinning, mesh, lists);
      if (!skinned) return fail("colliders[", body.collider, "].", skinned.why());
      const std::vector<std::uint32_t> order = cooking::locality_order(mesh);
      add_deltas(mesh, *skinned, order, false, lists);
      add_targets(mesh, *skinned, static_cast<std::uint32_t>(lists.meshes.size() - 1), order, lists);
      for (std::uint32_t k = 0; k < body.particles; ++k) {
        lists.points.push_back(point_of(mesh, *skinned, order[k], body.first_particle + k, {0, 1, 0}));
        lists.points.back().anchor = anchor + k;
      }
    }
    anchor += body.particles;
  }
  return {};
}

// After all that is cooked at rest: what a skin moves begins where the skin is. Then the skin leaves alone what it neither holds nor keeps near.
void lay_out(cooking::CookState& state) {
  CookedFabric& fabric = state.fabric();
  if (std::as_const(fabric.own).of<SkinLists>().points.empty()) return;
  auto& lists = fabric.own.of<SkinLists>();
  std::vector<Affine> joints = lists.first_pose;
  for (const SkinnedMesh& skinned : lists.meshes) {
    if (!skinned.is_collider) continue;
    const Collider& collider = state.scene().colliders[skinned.index];
    const Key key = pose_at(collider.keys, 0);
    const Affine place = affine(collider.centre + key.translate, rotation_about(key.axis, key.degrees) * rest_rotation(collider));
    for (std::uint32_t k = 0; k < skinned.joints; ++k) joints[skinned.first_joint + k] = place * joints[skinned.first_joint + k];
  }
  for (std::size_t k = 0; k < lists.points.size(); ++k) {
    const gpu::SkinPoint& point = lists.points[k];
    const Vec3 x = skinned_point(morphed(lists, k, lists.first_weights), joints);
    gpu::vec4& position = fabric.positions[point.particle];
    if (position.w == 0 && point.anchor == WEFT_NONE) continue;   // keys drive it
    position = {x.x, x.y, x.z, position.w};
    if (point.anchor < fabric.anchors.size()) fabric.anchors[point.anchor].rest = x;
  }
  keep(lists, [](const gpu::SkinPoint& point) { return point.anchor != WEFT_NONE || point.cloth != WEFT_NONE; });
}

}  // namespace

constinit const Effect skin{
    .name = "skin",
    .key = "skin",
    .called_for = [](const Scene&, const CookedFabric& fabric) { return !fabric.own.of<SkinLists>().points.empty(); },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize =
        [](const Cooked& s, Constants& constants) {
          const auto& lists = s.fabric.own.of<SkinLists>();
          constants[gpu::constant::skins_move_anchors] =
              std::ranges::any_of(lists.points, [](const gpu::SkinPoint& p) { return p.anchor != WEFT_NONE; });
          constants[gpu::constant::takes_targets] = lists.targets > 0;
          constants[gpu::constant::morphs] = lists.morph_deltas.empty() ? 0 : lists.morph_normals.empty() ? 1 : 2;
        },
    .reference = Reference::absent,
    .cook = cook,
    .cook_bodies = cook_bodies,
    .lay_out = lay_out,
};

}  // namespace weft::effects
