// See samples/godot/anchor.h.
#include "samples/godot/anchor.h"

#include <algorithm>

#include "samples/godot/poses.h"

namespace weft_godot {
namespace {

using godot::Hint;
using godot::Instance;
using godot::Property;
using godot::Variant;

constexpr int kEnterTree = 10;   // Node::NOTIFICATION_ENTER_TREE

Anchor& anchor_in(Instance& instance) { return static_cast<Anchor&>(instance); }
const Anchor& anchor_in(const Instance& instance) { return static_cast<const Anchor&>(instance); }

void changed(Instance& at) { at.call("update_configuration_warnings"); }

}  // namespace

void Anchor::notified(int what) {
  if (what == kEnterTree) call("update_configuration_warnings");
}

Variant Anchor::followed_node() const {
  if (follow.type() != GDEXTENSION_VARIANT_TYPE_NODE_PATH || follow.call("is_empty").to_bool()) return Variant(self());
  return call("get_node_or_null", follow);
}

std::optional<godot::Transform> Anchor::followed() const {
  const Variant node = followed_node();
  if (!godot::is(node.to_object(), "Node3D") || !node.call("is_inside_tree").to_bool()) return {};
  const godot::Transform at = node.call("get_global_transform").to_transform();
  if (bone.empty() || !godot::is(node.to_object(), "Skeleton3D")) return at;
  const std::int64_t found = node.call("find_bone", bone).to_int();
  if (found < 0) return {};
  return at * node.call("get_bone_global_pose", found).to_transform();
}

weft::Anchor Anchor::choice() const {
  weft::Anchor chosen;
  for (const std::int32_t v : vertices)
    if (v >= 0) chosen.vertices.push_back(static_cast<std::uint32_t>(v));
  chosen.map = map;
  if (top > 0) chosen.top = top;
  if (size.x > 0 && size.y > 0 && size.z > 0) {   // along the axes of the world, about where the anchor is
    const weft::Vec3 centre = call("get_global_transform").to_transform().origin, half = 0.5f * size;
    chosen.box = weft::Anchor::Box{centre - half, centre + half};
  }
  chosen.every = every;
  return chosen;
}

std::vector<std::string> Anchor::warnings() {
  std::vector<std::string> sentences;
  const Variant parent = call("get_parent");
  if (!godot::is(parent.to_object(), "WeftCloth3D")) sentences.push_back("It holds a WeftCloth3D: put it below one.");
  if (vertices.empty() && map.empty() && !(top > 0) && !(size.x > 0 && size.y > 0 && size.z > 0))
    sentences.push_back("It chooses no vertex: set vertices, a map, the top or a box.");
  if (!call("is_inside_tree").to_bool()) return sentences;
  const Variant node = followed_node();
  if (!godot::is(node.to_object(), "Node3D"))
    sentences.push_back("What it is to follow (\"" + follow.to_string() + "\") is no Node3D of the scene.");
  else if (!bone.empty() && !godot::is(node.to_object(), "Skeleton3D"))
    sentences.push_back("It is to follow the bone \"" + bone + "\" of a node that is no Skeleton3D.");
  else if (!followed()) sentences.push_back("The skeleton that it is to follow has no bone \"" + bone + "\".");
  return sentences;
}

const godot::Class& anchor_class() {
  static const godot::Class described = [] {
    const auto property = [](std::string name, godot::Type type, Hint hint, std::string text, std::string help, auto get, auto set) {
      return Property{std::move(name),
                      type,
                      hint,
                      std::move(text),
                      std::move(help),
                      [get](const Instance& at) { return get(anchor_in(at)); },
                      [set](Instance& at, const Variant& value) { set(anchor_in(at), value), changed(at); }};
    };
    using A = Anchor;
    using CA = const Anchor;
    std::vector<Property> choosing;
    choosing.push_back(property(
        "vertices", GDEXTENSION_VARIANT_TYPE_PACKED_INT32_ARRAY, Hint::none, "",
        "Numbers of vertices from 0, as the mesh has them, through all of its surfaces.",
        [](CA& a) { return Variant::packed(std::span(a.vertices)); }, [](A& a, const Variant& v) { a.vertices = v.to_ints(); }));
    choosing.push_back(property(
        "map", GDEXTENSION_VARIANT_TYPE_STRING, Hint::none, "",
        "Holds vertices where this is at least 1/2: a vertex colour with its channel (COLOR_0.r), a vertex group that a glTF "
        "has as a custom attribute (_NAME), or a painted picture over the UVs (pins.png.g).",
        [](CA& a) { return Variant(a.map); }, [](A& a, const Variant& v) { a.map = v.to_string(); }));
    choosing.push_back(property(
        "top", GDEXTENSION_VARIANT_TYPE_FLOAT, Hint::range, "0,100,0.001,or_greater,suffix:m",
        "Holds every vertex within this distance below the highest, as the cloth stands at the start. 0: none for that.",
        [](CA& a) { return Variant(a.top); }, [](A& a, const Variant& v) { a.top = std::clamp(v.to_double(), 0.0, 1e5); }));
    choosing.push_back(property(
        "box", GDEXTENSION_VARIANT_TYPE_VECTOR3, Hint::none, "suffix:m",
        "Holds every vertex within a box of this size about the anchor, along the axes of the world, at the start. 0: no box.",
        [](CA& a) { return Variant(a.size); }, [](A& a, const Variant& v) { a.size = v.to_vector3(); }));
    choosing.push_back(property(
        "every", GDEXTENSION_VARIANT_TYPE_INT, Hint::range, "1,1000,1,or_greater",
        "Of the chosen, sorted along their longest extent, holds each n-th and the last: rings of a curtain.",
        [](CA& a) { return Variant(a.every); },
        [](A& a, const Variant& v) { a.every = static_cast<std::uint32_t>(std::clamp<std::int64_t>(v.to_int(), 1, 3'999'999)); }));
    std::vector<Property> following;
    following.push_back(property(
        "follow", GDEXTENSION_VARIANT_TYPE_NODE_PATH, Hint::node, "Node3D",
        "What the vertices go with: a BoneAttachment3D, a Skeleton3D with a bone, any Node3D. Empty: the anchor itself, which goes "
        "with its parent.",
        [](CA& a) {
          return a.follow.type() == GDEXTENSION_VARIANT_TYPE_NODE_PATH ? a.follow : Variant::empty(GDEXTENSION_VARIANT_TYPE_NODE_PATH);
        },
        [](A& a, const Variant& v) { a.follow = v; }));
    following.push_back(property(
        "bone", GDEXTENSION_VARIANT_TYPE_STRING, Hint::none, "", "The bone's name, where a Skeleton3D is followed.",
        [](CA& a) { return Variant(a.bone); }, [](A& a, const Variant& v) { a.bone = v.to_string(); }));
    following.push_back(property(
        "with_skin", GDEXTENSION_VARIANT_TYPE_BOOL, Hint::none, "",
        "The vertices go where the cloth's skin takes them, each by its own bones, and follow nothing else.",
        [](CA& a) { return Variant(a.with_skin); }, [](A& a, const Variant& v) { a.with_skin = v.to_bool(); }));
    return godot::Class{"WeftAnchor3D",
                        "Node3D",
                        "Holds vertices of the WeftCloth3D above it.",
                        "What vertices, map, top and box choose is held, all of it together, and goes with the node that is followed. A "
                        "cloth may have several "
                        "anchors; a vertex that two choose belongs to the later one. Vertices are chosen when the simulation is made.",
                        {{"Holds", "", choosing}, {"Follows", "", following}},
                        {},
                        {},
                        [](godot::Object self) -> Instance* { return new Anchor(self); }};
  }();
  return described;
}

}  // namespace weft_godot
