// Skins in a frame: where their joints and the weights of their morph targets go, and what the host says of them.
#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/finite.h"
#include "engine/solve/state.h"

namespace weft {
namespace {

constexpr double kMostScale = 1e6;   // of max distances
constexpr double kMostWeight = 1e6;  // of a morph target

bool is_weight(float weight) { return std::abs(double(weight)) <= kMostWeight; }

bool is_sound(const Affine& m) {
  return is_finite(m.x) && is_finite(m.y) && is_finite(m.z) && is_finite(m.origin);
}

// How far the linear part moves a point, in double: far away the point itself is coarse.
Vec3 moved_origin(const Affine& m, Vec3 p) {
  const auto along = [&](float Vec3::*axis, double own) {
    return static_cast<float>(double(p.x) * m.x.*axis + double(p.y) * m.y.*axis + double(p.z) * m.z.*axis - own);
  };
  return {along(&Vec3::x, p.x), along(&Vec3::y, p.y), along(&Vec3::z, p.z)};
}

// Which of the skinned meshes is a cloth's or a collider's.
std::optional<std::size_t> number_of(std::span<const SkinnedMesh> meshes, bool is_collider, std::uint32_t index) {
  for (std::size_t m = 0; m < meshes.size(); ++m)
    if (meshes[m].is_collider == is_collider && meshes[m].index == index) return m;
  return std::nullopt;
}

}  // namespace

// At the frame's end, whose time it is already: what the host has set, or else what the animation has, or else what it was.
std::vector<Affine> Simulation::State::next_pose() const {
  std::vector<Affine> pose = skins.pose;
  for (std::size_t k = 0; k < skinned_meshes().size(); ++k) {
    const SkinnedMesh& skinned = skinned_meshes()[k];
    const auto joints = pose.begin() + skinned.first_joint;
    if (!skins.pending[k].empty())
      std::ranges::copy(skins.pending[k], joints);
    else if (!skins.is_host_driven[k] && skinned.animation != kNone)
      std::ranges::copy(joints_at(scene, skinned, meshes[skinned.mesh], now()), joints);
  }
  return pose;
}

// The same of morph targets' weights.
std::vector<float> Simulation::State::next_weights() const {
  std::vector<float> all = skins.weights;
  for (std::size_t k = 0; k < skinned_meshes().size(); ++k) {
    const SkinnedMesh& skinned = skinned_meshes()[k];
    const auto weights = all.begin() + skinned.first_morph;
    if (!skins.pending_weights[k].empty())
      std::ranges::copy(skins.pending_weights[k], weights);
    else if (!skins.has_host_weights[k] && skinned.animation != kNone)
      std::ranges::copy(weights_at(scene, skinned, meshes[skinned.mesh], now()), weights);
  }
  return all;
}

// Of a mesh collider in its own axes (m), as its skin has it, if there is one.
Result<std::vector<Vec3>> Simulation::State::body_shape(const ColliderMesh& mesh) {
  std::vector<Vec3> shape = collider_points(fabric, mesh, {}, {});
  const auto number = number_of(skinned_meshes(), true, mesh.collider);
  if (!number) return shape;
  const auto& lists = fabric.own.of<SkinLists>();
  if (skins.are_kept[*number]) {
    const ColliderPose& pose = bodies.poses[mesh.collider];
    const RigidMap back{parts::wide(pose.rotation).conjugate(), parts::wide(pose.centre), Eigen::Vector3d::Zero()};
    const std::size_t each = has_backstops(scene) ? 2 : 1;
    const auto ends = read(buffers::skin_ends, each * lists.points.size());
    if (!ends) return ends.why();
    for (std::size_t k = 0; k < lists.points.size(); ++k)
      if (const std::uint32_t own = lists.points[k].particle - mesh.first_particle; own < mesh.particles) {
        const gpu::vec4& end = (*ends)[each * k];
        shape[own] = back.place({end.x, end.y, end.z});
      }
    return shape;
  }
  for (std::size_t k = 0; k < lists.points.size(); ++k)
    if (const std::uint32_t own = lists.points[k].particle - mesh.first_particle; own < mesh.particles)
      shape[own] = skinned_point(morphed(lists, k, skins.weights), skins.pose);
  return shape;
}

// Takes what is kept of a mesh's points along, outside a frame.
Result<void> Simulation::State::carry_kept(bool is_collider, std::uint32_t index, const RigidMap& map) {
  const auto number = number_of(skinned_meshes(), is_collider, index);
  if (!number || !skins.are_kept[*number]) return {};
  const auto& lists = fabric.own.of<SkinLists>();
  const std::size_t each = has_backstops(scene) ? 2 : 1;
  auto ends = read(buffers::skin_ends, each * lists.points.size());
  if (!ends) return ends.take_error();
  for (std::size_t k = 0; k < lists.points.size(); ++k) {
    if (lists.target_rows[k].y != *number) continue;
    gpu::vec4& end = (*ends)[each * k];
    const Vec3 there = map.place({end.x, end.y, end.z});
    end = {there.x, there.y, there.z, 0};
    if (each < 2) continue;
    gpu::vec4& normal = (*ends)[each * k + 1];
    const Vec3 turned = map.way({normal.x, normal.y, normal.z});
    normal = {turned.x, turned.y, turned.z, 0};
  }
  return compute::upload(*device, solver->buffer(buffers::skin_ends), std::as_bytes(std::span(*ends)));
}

// Whether each mesh that takes targets goes in this frame where a buffer of the host's has it, stays where one had it, or goes with joints.
void Simulation::State::choose_sources(FrameInput& input) {
  skins.sources.clear();
  skins.copies.clear();
  for (std::size_t m = 0; m < skinned_meshes().size(); ++m) {
    const SkinnedMesh& skinned = skinned_meshes()[m];
    gpu::uint source = skins.are_kept[m] ? WEFT_FROM_KEPT : 0;
    if (std::optional<TargetBuffer>& targets = skins.pending_targets[m]) {
      const VkDeviceSize to = skinned.first_target * sizeof(gpu::vec4), bytes = skinned.targets * sizeof(gpu::vec4);
      source |= WEFT_TO_HOST;
      skins.copies.push_back({&buffers::host_targets, to, targets->positions, targets->positions_offset, bytes});
      if (targets->normals != VK_NULL_HANDLE) {
        source |= WEFT_HOST_NORMALS;
        skins.copies.push_back({&buffers::host_normals, to, targets->normals, targets->normals_offset, bytes});
      }
      targets.reset();
    } else if (skins.are_kept[m] && skins.pending[m].empty() && skins.pending_weights[m].empty()) {
      source |= WEFT_TO_KEPT;
    }
    input.anchors_move |= source != 0 && (source & WEFT_TO_KEPT) == 0;
    skins.sources.push_back(source);
  }
  input.skin_sources = skins.sources;
  input.host_copies = skins.copies;
}

// `before`: the colliders' poses where the frame begins; they have moved on. The GPU makes targets of joints and weights (skin.comp).
void Simulation::State::move_skins(std::span<const Affine> pose, std::span<const float> weights, std::span<const ColliderPose> before,
                                   FrameInput& input) {
  choose_sources(input);
  skins.joints.clear();
  skins.morph_weights.clear();
  for (std::size_t m = 0; m < skinned_meshes().size(); ++m) {
    const SkinnedMesh& skinned = skinned_meshes()[m];
    const auto place = [&](std::span<const ColliderPose> poses) {
      return skinned.is_collider ? affine(poses[skinned.index].centre, poses[skinned.index].rotation) : Affine{};
    };
    const Affine from = place(before), to = place(bodies.poses);
    for (std::uint32_t k = skinned.first_joint; k < skinned.first_joint + skinned.joints; ++k) {
      skins.joints.push_back(joint_between(from * skins.pose[k], to * pose[k]));
      input.anchors_move |= !(from == to) || !(skins.pose[k] == pose[k]);
    }
    skins.pending[m].clear();
    skins.pending_weights[m].clear();
  }
  for (std::size_t k = 0; k < weights.size(); ++k) {
    skins.morph_weights.push_back({skins.weights[k], weights[k]});
    input.anchors_move |= skins.weights[k] != weights[k];
  }
  const auto& lists = fabric.own.of<SkinLists>();
  // Where a host may tell targets instead, which only the GPU sees, a pose does to the bit what they do.
  if (lists.targets == 0 && !std::ranges::equal(pose, skins.pose))
    for (const gpu::SkinPoint& point : lists.points)
      if (point.anchor != WEFT_NONE) hasten(point.particle, skinned_point(point, skins.pose), skinned_point(point, pose));
  std::ranges::copy(pose, skins.pose.begin());
  std::ranges::copy(weights, skins.weights.begin());
  input.morph_weights = skins.morph_weights;
  input.joints = skins.joints;
  input.motion_limits = skins.limits;
}

Result<void> Simulation::State::set_joints(bool is_collider, std::uint32_t index, std::span<const Affine> joints) {
  const std::string name = fail(is_collider ? "collider " : "cloth ", index).message;
  const auto number = number_of(skinned_meshes(), is_collider, index);
  if (!number)
    return fail(name, " has no skin that a pose could move: there is none, or the scene does not ask for one (its key \"skin\")");
  const SkinnedMesh& skinned = skinned_meshes()[*number];
  if (joints.size() != skinned.joints) return fail("the pose of ", name, " has ", joints.size(), " joints, and its skin ", skinned.joints);
  std::vector<Affine> pose(joints.begin(), joints.end());
  for (std::size_t k = 0; k < pose.size(); ++k) {
    if (!is_sound(pose[k])) return fail("joint ", k, " of the pose of ", name, " is not finite, or moves by ", kTooLarge, " m or more");
    // Particles are relative to the origin, and a mesh collider's to its centre.
    if (!is_collider) pose[k].origin = pose[k].origin + moved_origin(pose[k], origin);
  }
  skins.pending[*number] = std::move(pose);
  skins.is_host_driven[*number] = true;
  return {};
}

Result<void> Simulation::State::set_targets(bool is_collider, std::uint32_t index, const TargetBuffer& targets) {
  const std::string name = fail(is_collider ? "collider " : "cloth ", index).message;
  const auto number = number_of(skinned_meshes(), is_collider, index);
  if (!number || skinned_meshes()[*number].targets == 0)
    return fail(name, " takes no targets: it has no skin, or the scene does not ask for them (the key \"takes_targets\" of its \"skin\")");
  if (targets.positions == VK_NULL_HANDLE) return fail("the targets of ", name, ": `positions` is VK_NULL_HANDLE");
  const SkinnedMesh& skinned = skinned_meshes()[*number];
  if (targets.vertices != skinned.targets)
    return fail("the targets of ", name, " are of ", targets.vertices, " vertices, and it has ", skinned.targets);
  skins.pending_targets[*number] = targets;
  skins.is_host_driven[*number] = skins.has_host_weights[*number] = true;
  return {};
}

Result<void> Simulation::State::set_weights(bool is_collider, std::uint32_t index, std::span<const float> weights) {
  const std::string name = fail(is_collider ? "collider " : "cloth ", index).message;
  const auto number = number_of(skinned_meshes(), is_collider, index);
  if (!number)
    return fail(name, " has no skin whose morph targets could have weights: there is none, or the scene does not ask for one",
                " (its key \"skin\")");
  const SkinnedMesh& skinned = skinned_meshes()[*number];
  if (weights.size() != skinned.morphs)
    return fail(weights.size(), " weights were given for the ", skinned.morphs, " morph targets of ", name);
  for (std::size_t k = 0; k < weights.size(); ++k)
    if (!is_weight(weights[k]))
      return fail("weight ", k, " of ", name, "'s morph targets is ", weights[k], ", not from -", kMostWeight, " to ", kMostWeight);
  skins.pending_weights[*number].assign(weights.begin(), weights.end());
  skins.has_host_weights[*number] = true;
  return {};
}

// Errors: what is damaged.
Result<void> Simulation::State::check_skins(const Snapshot& snapshot) const {
  if (snapshot.skins.size() != skinned_meshes().size())
    return fail("it has ", snapshot.skins.size(), " skins instead of ", skinned_meshes().size());
  for (std::size_t k = 0; k < snapshot.skins.size(); ++k) {
    const Snapshot::SkinState& state = snapshot.skins[k];
    const std::size_t joints = skinned_meshes()[k].joints, morphs = skinned_meshes()[k].morphs;
    const auto fits = [](const auto& values, const auto& pending, std::size_t count, const auto& is_good) {
      return values.size() == count && (pending.empty() || pending.size() == count) && std::ranges::all_of(values, is_good) &&
             std::ranges::all_of(pending, is_good);
    };
    if (!fits(state.pose, state.pending, joints, is_sound))
      return fail("skin ", k, " has another number of joints than ", joints, ", or one that is not finite");
    if (!fits(state.weights, state.pending_weights, morphs, is_weight))
      return fail("skin ", k, " has another number of weights than ", morphs, ", or one that is not finite");
  }
  for (std::size_t k = 0; k < snapshot.skins.size(); ++k)
    if (snapshot.skins[k].is_kept && skinned_meshes()[k].targets == 0) return fail("skin ", k, " is where a buffer had it, and takes none");
  if (snapshot.motion_limits.size() != skins.limits.size())
    return fail("it has motion constraints of ", snapshot.motion_limits.size(), " cloths instead of ", skins.limits.size());
  for (const auto& [scale, stiffness] : snapshot.motion_limits)
    if (!(scale >= 0 && scale <= kMostScale && stiffness >= 0 && stiffness <= 1))
      return fail("motion constraints have a scale of ", scale, " and a stiffness of ", stiffness);
  return {};
}

// As a snapshot that was checked has them.
Skins Simulation::State::skins_of(const Snapshot& snapshot) const {
  Skins there = skins;
  for (std::size_t k = 0; k < snapshot.skins.size(); ++k) {
    std::ranges::copy(snapshot.skins[k].pose, there.pose.begin() + skinned_meshes()[k].first_joint);
    there.pending[k] = snapshot.skins[k].pending;
    there.is_host_driven[k] = snapshot.skins[k].is_host_driven;
    std::ranges::copy(snapshot.skins[k].weights, there.weights.begin() + skinned_meshes()[k].first_morph);
    there.pending_weights[k] = snapshot.skins[k].pending_weights;
    there.has_host_weights[k] = snapshot.skins[k].has_host_weights;
    there.pending_targets[k].reset();
    there.are_kept[k] = snapshot.skins[k].is_kept;
  }
  for (std::size_t k = 0; k < there.limits.size(); ++k)
    there.limits[k] = {snapshot.motion_limits[k].scale, snapshot.motion_limits[k].stiffness};
  there.joints.reserve(there.pose.size());
  there.morph_weights.reserve(there.weights.size());
  there.sources.clear();
  there.sources.reserve(snapshot.skins.size());
  there.copies.reserve(2 * snapshot.skins.size());
  return there;
}

Result<void> Simulation::set_pose(std::uint32_t cloth, std::span<const Affine> joints) try {
  return state_->set_joints(false, cloth, joints);
} catch (...) {
  return caught("the pose");
}

Result<void> Simulation::set_body_pose(std::uint32_t collider, std::span<const Affine> joints) try {
  return state_->set_joints(true, collider, joints);
} catch (...) {
  return caught("the pose");
}

Result<void> Simulation::set_morphs(std::uint32_t cloth, std::span<const float> weights) try {
  return state_->set_weights(false, cloth, weights);
} catch (...) {
  return caught("the weights");
}

Result<void> Simulation::set_body_morphs(std::uint32_t collider, std::span<const float> weights) try {
  return state_->set_weights(true, collider, weights);
} catch (...) {
  return caught("the weights");
}

Result<void> Simulation::set_targets(std::uint32_t cloth, const TargetBuffer& targets) try {
  return state_->set_targets(false, cloth, targets);
} catch (...) {
  return caught("the targets");
}

Result<void> Simulation::set_body_targets(std::uint32_t collider, const TargetBuffer& targets) try {
  return state_->set_targets(true, collider, targets);
} catch (...) {
  return caught("the targets");
}

Result<void> Simulation::limit_motion(std::uint32_t cloth, double scale, double stiffness) try {
  const std::vector<Cloth>& cloths = state_->scene.cloths;
  if (cloth >= cloths.size() || !cloths[cloth].motion_constraints)
    return fail("cloth ", cloth, " has no motion constraints (its key \"motion_constraints\")");
  if (!(scale >= 0 && scale <= kMostScale))
    return fail("the scale of cloth ", cloth, "'s max distances is ", scale, ", not from 0 to ", kMostScale);
  if (!(stiffness >= 0 && stiffness <= 1))
    return fail("the stiffness of cloth ", cloth, "'s motion constraints is ", stiffness, ", not from 0 to 1");
  state_->skins.limits[cloth] = {static_cast<float>(scale), static_cast<float>(stiffness)};
  return {};
} catch (...) {
  return caught("the motion constraints");
}

}  // namespace weft
