// See samples/godot/skin.h.
#include "samples/godot/skin.h"

namespace weft_godot {
namespace {

using godot::Variant;
using weft::Affine;
using weft::Vec3;
using weft::Vec4;

Affine affine(const godot::Transform& t) {
  const auto column = [&](int k) { return Vec3{t.rows[0][k], t.rows[1][k], t.rows[2][k]}; };
  return {column(0), column(1), column(2), t.origin};
}

godot::Transform transform(const Affine& m) { return {{{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}}, m.origin}; }

Variant skeleton_of(const Variant& node) {
  const Variant path = node.call("get_skeleton_path");
  const bool is_set = path.type() == GDEXTENSION_VARIANT_TYPE_NODE_PATH && !path.call("is_empty").to_bool();
  const Variant found = is_set && node.call("is_inside_tree").to_bool() ? node.call("get_node_or_null", path) : Variant();
  return godot::is(found.to_object(), "Skeleton3D") ? found : Variant();
}

// Godot's importer makes other names where one has a colon or a slash, which its paths of properties have: "mixamorig:Hips".
std::int64_t bone_of(const Variant& skeleton, std::string name) {
  for (char& c : name)
    if (c == ':' || c == '/') c = '_';
  return skeleton.call("find_bone", name).to_int();
}

// Joints of a mesh of Godot's are binds of a Skin, or bones where there is none.
void name_joints(weft::Skin& skin, const Variant& binds, const Variant& skeleton, std::vector<std::int64_t>& bones) {
  const std::int64_t all = skeleton.call("get_bone_count").to_int();
  for (std::size_t k = 0; k < skin.joints.size(); ++k) {
    const auto number = static_cast<std::int64_t>(k);
    std::int64_t bone = -1;
    godot::Transform bind;
    if (!binds.to_object()) {
      bone = number < all ? number : -1;
      if (bone >= 0) bind = inverse(skeleton.call("get_bone_global_rest", bone).to_transform()).value_or(bind);
    } else if (number < binds.call("get_bind_count").to_int()) {
      const std::string name = binds.call("get_bind_name", number).to_string();
      bone = name.empty() ? binds.call("get_bind_bone", number).to_int() : skeleton.call("find_bone", name).to_int();
      bind = binds.call("get_bind_pose", number).to_transform();
      skin.joints[k].name = name;
    }
    if (bone >= all) bone = -1;
    if (skin.joints[k].name.empty()) skin.joints[k].name = bone >= 0 ? skeleton.call("get_bone_name", bone).to_string() : "";
    skin.joints[k].inverse_bind = affine(bind);
    bones.push_back(bone);
  }
}

constexpr std::int64_t kCarrier = -1, kNode = -2;

weft::Skin rigid(std::size_t points) {
  weft::Skin skin;
  skin.joints.resize(1);
  skin.joints[0].name = Skin::kOfNode;
  skin.joints_of.assign(points, {0, 0, 0, 0});
  skin.weights.assign(points, {1, 0, 0, 0});
  return skin;
}

}  // namespace

Skin Skin::bind(godot::Object object, const godot::Transform& start, bool with_node, weft::Mesh& mesh, std::string& fault) {
  const Variant node(object), skeleton = skeleton_of(node);
  Skin bound;
  bound.node_ = godot::id_of(object);
  const bool has_joints = mesh.skin && !mesh.skin->joints.empty();
  if (has_joints && !skeleton.to_object())
    fault = "Its mesh has joints, but its skeleton is no Skeleton3D of the scene: all of it goes with the node.";
  if (!has_joints || !skeleton.to_object()) {
    mesh.skin = rigid(mesh.points.size());
    mesh.skin->place = affine(start);
    bound.carrier_ = godot::id_of(object);
    bound.bones_ = {kCarrier};
  } else {
    bound.carrier_ = godot::id_of(skeleton.to_object());
    if (mesh.skin->nodes.empty()) {
      name_joints(*mesh.skin, node.call("get_skin"), skeleton, bound.bones_);
    } else {   // a file's
      for (const weft::Skin::Joint& joint : mesh.skin->joints) bound.bones_.push_back(bone_of(skeleton, joint.name));
    }
    for (std::size_t k = 0; k < bound.bones_.size(); ++k)
      if (bound.bones_[k] < 0)
        fault = "Its joint \"" + mesh.skin->joints[k].name + "\" is no bone of the skeleton: it goes with the skeleton's node.";
    if (with_node) {
      mesh.skin->joints.push_back({.name = kOfNode, .node = 0, .inverse_bind = {}});
      bound.bones_.push_back(kNode);
    }
  }
  // From here on the mesh's space is the world's, and each joint has a node of its own there.
  weft::Skin& skin = *mesh.skin;
  const godot::Transform back = inverse(transform(skin.place)).value_or(godot::Transform{});
  skin.nodes.assign(skin.joints.size(), {});
  for (std::size_t k = 0; k < skin.joints.size(); ++k) {
    skin.joints[k].node = static_cast<std::uint32_t>(k);
    skin.joints[k].inverse_bind = affine(transform(skin.joints[k].inverse_bind) * back);
  }
  skin.place = {};
  skin.morphs.clear();
  bound.bones_at_.resize(bound.bones_.size());
  set_keys(skin, bound.look());
  return bound;
}

const std::vector<Placed>& Skin::look() {
  const Variant carrier(godot::object_of(carrier_));
  if (!carrier.to_object() || !carrier.call("is_inside_tree").to_bool()) return bones_at_;
  const godot::Transform at = carrier.call("get_global_transform").to_transform();
  for (std::size_t k = 0; k < bones_.size(); ++k) {
    godot::Transform there = at;
    if (bones_[k] >= 0) there = at * carrier.call("get_bone_global_pose", bones_[k]).to_transform();
    const Variant node(bones_[k] == kNode ? godot::object_of(node_) : nullptr);
    if (node.to_object()) there = node.call("get_global_transform").to_transform();
    if (const auto now = placed(there)) bones_at_[k] = *now;
  }
  return bones_at_;
}

void set_keys(weft::Skin& skin, std::span<const Placed> bones) {
  skin.animations = {{"pose", {}}};
  using Moves = weft::Skin::Moves;
  for (std::uint32_t k = 0; k < bones.size(); ++k)
    for (const Moves moves : {Moves::translation, Moves::rotation, Moves::scale})
      skin.animations[0].channels.push_back({k, moves, weft::Skin::Interpolation::step, {}, {}});
  add_keys(skin, 0, bones);
}

void add_keys(weft::Skin& skin, float time, std::span<const Placed> bones) {
  std::vector<weft::Skin::Channel>& channels = skin.animations[0].channels;
  for (std::size_t k = 0; k < bones.size(); ++k) {
    const auto& [at, turn, scale] = bones[k];
    const Vec4 values[] = {{at.x, at.y, at.z, 0}, {turn.x, turn.y, turn.z, turn.w}, {scale.x, scale.y, scale.z, 0}};
    for (std::size_t c = 0; c < 3; ++c) {
      channels[3 * k + c].times.push_back(time);
      channels[3 * k + c].values.push_back(values[c]);
    }
  }
}

}  // namespace weft_godot
