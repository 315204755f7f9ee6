// The class WeftCloth3D: its properties and methods, and what the editor says of them.
#include <algorithm>

#include "samples/godot/cloth.h"
#include "samples/godot/fields.h"

namespace weft_godot {
namespace {

using godot::Hint;
using godot::Instance;
using godot::Method;
using godot::Property;
using godot::Variant;

bool in_editor() { return godot::singleton("Engine").call("is_editor_hint").to_bool(); }

Cloth& cloth_in(Instance& instance) { return static_cast<Cloth&>(instance); }
const Cloth& cloth_in(const Instance& instance) { return static_cast<const Cloth&>(instance); }

constexpr godot::Type kVertices = GDEXTENSION_VARIANT_TYPE_PACKED_INT32_ARRAY, kPoint = GDEXTENSION_VARIANT_TYPE_VECTOR3,
                      kPoints = GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR3_ARRAY, kWhole = GDEXTENSION_VARIANT_TYPE_INT,
                      kNothing = GDEXTENSION_VARIANT_TYPE_NIL;

std::vector<std::uint32_t> numbers(const Variant& list) {
  std::vector<std::uint32_t> numbers;
  for (const std::int32_t v : list.to_ints()) numbers.push_back(static_cast<std::uint32_t>(v));   // one below 0 is far above all there are
  return numbers;
}

// What hands do to cloth.
std::vector<Method> hands() {
  using Does = Hand::Does;
  return {
      {"pin",
       {{"vertices", kVertices}},
       kNothing,
       "Holds vertices, numbered as in get_vertices(), each where it is, from the next tick on. The world's `pins` says how many there may "
       "be.",
       [](Instance& at, std::span<const Variant> given) {
         return cloth_in(at).act({.what = Does::pin, .vertices = numbers(given[0])}), Variant();
       }},
      {"release",
       {{"vertices", kVertices}},
       kNothing,
       "Lets go of vertices, pinned ones or those of anchors, from the next tick on. The world's `pins` must be above 0.",
       [](Instance& at, std::span<const Variant> given) {
         return cloth_in(at).act({.what = Does::release, .vertices = numbers(given[0])}), Variant();
       }},
      {"move_pins",
       {{"vertices", kVertices}, {"targets", kPoints}},
       kNothing,
       "Where vertices that are held are at the end of the next tick, in the world. Those of an anchor do not follow its node any more.",
       [](Instance& at, std::span<const Variant> given) {
         return cloth_in(at).act({.what = Does::move_pins, .vertices = numbers(given[0]), .targets = given[1].to_vectors3()}), Variant();
       }},
      {"grab",
       {{"origin", kPoint}, {"direction", kPoint}},
       GDEXTENSION_VARIANT_TYPE_DICTIONARY,
       "Takes hold of cloth of this one's world, with this one's grip, where a ray first meets it. Gives {grab, cloth, point, distance}: a "
       "number for move_grab() and let_go(), the WeftCloth3D that was met, the place (m, in the world) and how far it is along the ray; "
       "empty where the ray meets no cloth. Shapes hide nothing: compare distances. The world's `grabs` says how many there may be. Waits "
       "for the GPU.",
       [](Instance& at, std::span<const Variant> given) { return cloth_in(at).grab(given[0].to_vector3(), given[1].to_vector3()); }},
      {"move_grab",
       {{"grab", kWhole}, {"target", kPoint}},
       kNothing,
       "Where a grab pulls to, at the end of the next tick, in the world.",
       [](Instance& at, std::span<const Variant> given) {
         return cloth_in(at).act({.what = Does::move_grab, .targets = {given[1].to_vector3()}, .grab = given[0].to_int()}), Variant();
       }},
      {"let_go",
       {{"grab", kWhole}},
       kNothing,
       "Ends a grab in the next tick: the cloth flies on.",
       [](Instance& at, std::span<const Variant> given) {
         return cloth_in(at).act({.what = Does::let_go, .grab = given[0].to_int()}), Variant();
       }},
      {"cut",
       {{"origin", kPoint}, {"a", kPoint}, {"b", kPoint}},
       kWhole,
       "Cuts all cloth of this one's world that tears along a blade, the plane between two rays from an origin in the directions a and b. "
       "Gives how many vertices have become two. Waits for the GPU.",
       [](Instance& at, std::span<const Variant> given) {
         return Variant(cloth_in(at).cut(given[0].to_vector3(), given[1].to_vector3(), given[2].to_vector3()));
       }}};
}

std::vector<Method> methods() {
  std::vector<Method> all{
      {"get_fault",
       {},
       GDEXTENSION_VARIANT_TYPE_STRING,
       "Why the cloth stands still; empty where it does not.",
       [](Instance& at, std::span<const Variant>) { return Variant(cloth_in(at).fault()); }},
      {"get_warnings",
       {},
       GDEXTENSION_VARIANT_TYPE_PACKED_STRING_ARRAY,
       "What the tree says of it in the editor.",
       [](Instance& at, std::span<const Variant>) {
         const std::vector<std::string> sentences = at.warnings();
         return Variant::packed(std::span(sentences));
       }},
      {"restart",
       {},
       GDEXTENSION_VARIANT_TYPE_NIL,
       "Begins anew where the node is, with the properties as they are.",
       [](Instance& at, std::span<const Variant>) { return cloth_in(at).restart(), Variant(); }},
      {"get_vertices",
       {},
       GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR3_ARRAY,
       "Where the vertices are after the last tick, in the world (m). Waits for the GPU, and copies: for a look, not for every frame.",
       [](Instance& at, std::span<const Variant>) {
         const std::vector<weft::Vec3> vertices = cloth_in(at).vertices();
         return Variant::packed(std::span(vertices));
       }}};
  for (Method& method : hands()) all.push_back(std::move(method));
  return all;
}

}  // namespace

const godot::Class& cloth_class() {
  static const godot::Class described = [] {
    const auto property = [](std::string name, godot::Type type, Hint hint, std::string text, std::string help, auto get, auto set) {
      return Property{std::move(name),
                      type,
                      hint,
                      std::move(text),
                      std::move(help),
                      [get](const Instance& at) { return Variant(get(cloth_in(at))); },
                      [set](Instance& at, const Variant& value) {
                        set(cloth_in(at), value);
                        at.call("update_configuration_warnings");
                      }};
    };
    using C = Cloth;
    using CC = const Cloth;
    // Whether the cloth has something; what follows in the group is shown if so.
    const auto flag = [&property](std::string name, std::string help, bool Cloth::*at) {
      Property made = property(
          std::move(name), GDEXTENSION_VARIANT_TYPE_BOOL, Hint::none, "", std::move(help), [at](CC& c) { return c.*at; },
          [at](C& c, const Variant& v) { c.*at = v.to_bool(), c.call("notify_property_list_changed"); });
      made.updates_all = true;
      return made;
    };
    const auto number = [&property](std::string name, std::string range, std::string help, std::function<double&(C&)> at) {
      return property(
          std::move(name), GDEXTENSION_VARIANT_TYPE_FLOAT, Hint::range, std::move(range), std::move(help),
          [at](CC& c) { return at(const_cast<C&>(c)); }, [at](C& c, const Variant& v) { at(c) = std::max(0.0, v.to_double()); });
    };
    std::vector<Property> own;
    own.push_back(property(
        "world", GDEXTENSION_VARIANT_TYPE_OBJECT, Hint::resource, "WeftWorld",
        "Solver, contacts and air, which cloths share. Those without one share a world with the defaults.", [](CC& c) { return c.world; },
        [](C& c, const Variant& v) { c.world = v; }));
    own.back().type_name = "WeftWorld";
    own.push_back(property(
        "gltf", GDEXTENSION_VARIANT_TYPE_STRING, Hint::file, "*.glb,*.gltf,*.obj",
        "A file to read the cloth's mesh from, in place of the node's: with vertex groups as custom attributes (_NAME). Its material is "
        "the node's material override. It must lie on the disk, so that it is not there in an exported package. The node's `mesh` is then "
        "the file's, and is not saved.",
        [](CC& c) { return c.gltf(); }, [](C& c, const Variant& v) { c.set_gltf(v.to_string()), c.call("notify_property_list_changed"); }));
    own.push_back(property(
        "collision_mask", GDEXTENSION_VARIANT_TYPE_INT, Hint::layers_3d_physics, "",
        "Layers of the physics bodies that the cloth meets: spheres, capsules, boxes, world boundaries and concave meshes.",
        [](CC& c) { return std::int64_t(c.collision_mask); },
        [](C& c, const Variant& v) { c.collision_mask = static_cast<std::uint32_t>(v.to_int()); }));
    own.push_back(property(
        "tethers", GDEXTENSION_VARIANT_TYPE_BOOL, Hint::none, "",
        "Keeps every vertex within reach of the anchors, so that large cloth does not sag.", [](CC& c) { return c.tethers; },
        [](C& c, const Variant& v) { c.tethers = v.to_bool(); }));
    own.push_back(property(
        "bending", GDEXTENSION_VARIANT_TYPE_BOOL, Hint::none, "", "Whether the cloth resists bending.", [](CC& c) { return c.bending; },
        [](C& c, const Variant& v) { c.bending = v.to_bool(); }));
    own.push_back(property(
        "keeps_folds", GDEXTENSION_VARIANT_TYPE_BOOL, Hint::none, "",
        "Whether it bends about the shape of its mesh, with its folds, and not about a flat one.", [](CC& c) { return c.keeps_folds; },
        [](C& c, const Variant& v) { c.keeps_folds = v.to_bool(); }));
    std::vector<Property> fabric;
    Property preset = property(
        "fabric_preset", GDEXTENSION_VARIANT_TYPE_INT, Hint::choice, "Silk,Cotton,Denim,Leather,Own figures",
        "What the cloth is made of; own figures begin with those of the preset before.", [](CC& c) { return c.preset; },
        [](C& c, const Variant& v) {
          const int next = static_cast<int>(std::clamp<std::int64_t>(v.to_int(), 0, C::kOwn));
          if (next == C::kOwn && c.preset != C::kOwn && in_editor()) c.own_fabric = c.fabric();
          c.preset = next;
          c.call("notify_property_list_changed");
        });
    preset.updates_all = true;
    fabric.push_back(preset);
    const std::function<weft::Fabric&(Instance&)> figures = [](Instance& at) -> weft::Fabric& { return cloth_in(at).own_fabric; };
    for (Property& figure : properties_of("fabric_", "fabric", figures, {"preset"})) fabric.push_back(std::move(figure));
    const std::function<weft::Maps&(Instance&)> maps = [](Instance& at) -> weft::Maps& { return cloth_in(at).maps; };
    const auto group = [](std::vector<Property> first, std::vector<Property> fields) {
      for (Property& field : fields) first.push_back(std::move(field));
      return first;
    };
    const std::function<weft::MotionConstraints&(Instance&)> motion = [](Instance& at) -> weft::MotionConstraints& {
      return cloth_in(at).motion;
    };
    const std::function<weft::Gas&(Instance&)> gas = [](Instance& at) -> weft::Gas& { return cloth_in(at).gas; };
    const std::function<weft::Tear&(Instance&)> tear = [](Instance& at) -> weft::Tear& { return cloth_in(at).tear; };
    const std::vector<Property> of_motion =
        group({flag("motion_enabled",
                    "Keeps every vertex near the place to which the skin takes it: bones of the node's skeleton, or the node itself where "
                    "the mesh has no joints.",
                    &C::has_motion),
               number("motion_scale", "0,1000,0.001,or_greater",
                      "What max distances are multiplied by; may change while it plays, as may the stiffness.",
                      [](C& c) -> double& { return c.motion_scale; })},
              properties_of("motion_", "motion_constraints", motion));
    const std::function<weft::Inertia&(Instance&)> inertia = [](Instance& at) -> weft::Inertia& { return cloth_in(at).inertia; };
    const std::vector<Property> of_inertia = group(
        {flag("inertia_enabled",
              "Says how much the cloth feels of its node's motion, a character's, say: 1 all of it, 0 nothing, as if the node stood still.",
              &C::has_inertia)},
        properties_of("inertia_", "inertia", inertia, {"joint"}));
    const std::vector<Property> of_gas =
        group({flag("pressure_enabled", "Whether there is a gas in the cloth, whose mesh must be closed.", &C::has_gas),
               number("pressure_amount", "0,1000,0.001",
                      "How much gas there is, as a multiple of what the other figures say; may change while it plays: 0 is a vacuum.",
                      [](C& c) -> double& { return c.gas_amount; })},
              properties_of("pressure_", "pressure", gas));
    const std::vector<Property> of_tear =
        group({flag("tear_enabled", "Whether the cloth tears, and can be cut.", &C::has_tear)}, properties_of("tear_", "tear", tear));
    const std::vector<Property> of_grip{number("grip_stiffness", "0.001,1e9,0.001,hide_slider,suffix:N/m", "How stiffly grab() pulls.",
                                               [](C& c) -> double& { return c.grip.stiffness; }),
                                        number("grip_damping", "0,1e9,0.001,hide_slider,suffix:N s/m",
                                               "Damping against the motion of its target.", [](C& c) -> double& { return c.grip.damping; }),
                                        number("grip_force", "0.001,1e9,0.001,hide_slider,suffix:N", "The most that it pulls with.",
                                               [](C& c) -> double& { return c.grip.force; })};
    return godot::Class{"WeftCloth3D",
                        "MeshInstance3D",
                        "Cloth, simulated by Weft on the GPU on which Godot draws.",
                        "The node's mesh is cloth: it starts where the node is, is held by the WeftAnchor3D nodes below it, and meets the "
                        "collision shapes of the tree. The node's transform says where it starts, and moves anchors that follow nothing "
                        "else; the cloth itself goes where physics takes it. It stops with the tree's pause, slows with Engine.time_scale, "
                        "and lies between ticks where the project interpolates physics. In the editor it is shown at rest.",
                        {{"Cloth", "", own},
                         {"Fabric", "fabric_", fabric},
                         {"Maps", "maps_", properties_of("maps_", "maps", maps)},
                         {"Motion Constraints", "motion_", of_motion},
                         {"Inertia", "inertia_", of_inertia},
                         {"Pressure", "pressure_", of_gas},
                         {"Tearing", "tear_", of_tear},
                         {"Grip", "grip_", of_grip}},
                        methods(),
                        {{"started", {}, "It is simulated from now on, or again."},
                         {"torn", {}, "It has torn, or was cut: what is drawn has come apart."},
                         {"failed", {{"sentence", GDEXTENSION_VARIANT_TYPE_STRING}}, "It stands still, and why."}},
                        [](godot::Object self) -> Instance* { return new Cloth(self); }};
  }();
  return described;
}

}  // namespace weft_godot
