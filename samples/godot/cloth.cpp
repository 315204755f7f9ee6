// See samples/godot/cloth.h.
#include "samples/godot/cloth.h"

#include <numbers>

#include "samples/godot/fields.h"
#include "samples/godot/meshes.h"
#include "samples/godot/poses.h"
#include "samples/godot/stage.h"

namespace weft_godot {
namespace {

using godot::Hint;
using godot::Instance;
using godot::Property;
using godot::Variant;
using weft::fail;
using weft::Result;

// Node::NOTIFICATION_*
enum Notification { kEnterTree = 10, kExitTree = 11, kInternalPhysics = 26 };

constexpr const char* kPresets[] = {"silk", "cotton", "denim", "leather", "own"};
constexpr int kOwn = 4;
constexpr int kLast = 1 << 20;   // of priorities: after all that moves

bool in_editor() { return godot::singleton("Engine").call("is_editor_hint").to_bool(); }

Cloth& cloth_in(Instance& instance) { return static_cast<Cloth&>(instance); }
const Cloth& cloth_in(const Instance& instance) { return static_cast<const Cloth&>(instance); }

// res:// and user:// as paths of the disk.
std::string on_disk(const std::string& path) { return godot::singleton("ProjectSettings").call("globalize_path", path).to_string(); }

}  // namespace

Cloth::~Cloth() { leave(); }

void Cloth::leave() {
  if (stage_ != nullptr) stage_->remove(*this);
  stage_ = nullptr;
}

void Cloth::notified(int what) {
  if (what == kEnterTree) {
    call("update_configuration_warnings");
    if (in_editor()) return;
    if (call("get_physics_process_priority").to_int() == 0) call("set_physics_process_priority", kLast);
    call("set_physics_process_internal", true);
    stage_ = &Stage::of(world);
    stage_->add(*this);
  }
  if (what == kExitTree) leave();
  if (what == kInternalPhysics && stage_ != nullptr) stage_->tick(call("get_physics_process_delta_time").to_double());
}

bool Cloth::shows(std::string_view property) const {
  return preset == kOwn || !property.starts_with("fabric_") || property == "fabric_preset";
}

weft::Fabric Cloth::fabric() const {
  if (preset == kOwn) return own_fabric;
  const std::optional<weft::Fabric> named = weft::fabric_preset(kPresets[preset]);
  return named ? *named : weft::Fabric{};
}

Result<weft::Mesh> Cloth::mesh() const {
  if (!gltf.empty()) return weft::load_mesh(on_disk(gltf));
  return mesh_of(call("get_mesh"));
}

Result<Cloth::Described> Cloth::describe() const {
  Described described;
  auto own = mesh();
  if (!own) return own.take_error();
  described.mesh = std::move(*own);
  const godot::Transform at = call("is_inside_tree").to_bool() ? call("get_global_transform").to_transform() : godot::Transform{};
  const std::optional<Placed> place = placed(at);
  if (!place || !is_even(place->scale)) return fail("its node is mirrored, sheared or scaled unevenly, which cloth cannot be");
  const double sine = std::hypot(place->rotation.x, place->rotation.y, place->rotation.z);
  weft::Transform transform;
  transform.translate = place->at;
  if (sine > 0) transform.axis = float(1 / sine) * weft::Vec3{place->rotation.x, place->rotation.y, place->rotation.z};
  transform.degrees = 2 * std::atan2(sine, double(place->rotation.w)) * 180 / std::numbers::pi;
  transform.scale = place->scale.x;
  weft::transform_mesh(described.mesh, transform);

  weft::Cloth& cloth = described.cloth;
  cloth.name = call("get_name").to_string();
  cloth.mesh = "mesh";
  cloth.fabric = fabric();
  cloth.maps = maps;
  cloth.tethers = tethers;
  cloth.bending = bending;
  if (keeps_folds) cloth.bend_rest = weft::BendRest::mesh;
  const Variant children = call("get_children");
  const std::int64_t count = children.call("size").to_int();
  for (std::int64_t k = 0; k < count; ++k) {
    auto* anchor = dynamic_cast<Anchor*>(godot::instance_of(children.call("get", k).to_object()));
    if (anchor == nullptr) continue;
    cloth.anchors.push_back(anchor->choice());
    cloth.anchors.back().keys = {weft::Key{}};
    described.anchors.push_back(anchor);
  }
  return described;
}

Result<void> Cloth::check_alone(const Described& described, const Shared& shared) {
  weft::Scene scene;
  scene.solver = shared.solver;
  scene.contacts = shared.contacts;
  scene.air = shared.air;
  scene.cloths = {described.cloth};
  if (auto good = weft::check(scene); !good) return good;
  if (auto good = weft::check(described.mesh); !good) return good;
  const auto cooked = weft::cook(scene, std::span(&described.mesh, 1));
  return cooked ? Result<void>() : Result<void>(weft::Error{cooked.error()});
}

std::vector<std::string> Cloth::warnings() {
  std::vector<std::string> sentences;
  if (!fault_.empty()) sentences.push_back("It stands still: " + fault_);
  const auto described = describe();
  if (!described) {
    sentences.push_back("It cannot be cloth: " + described.error());
    return sentences;
  }
  if (const auto good = check_alone(*described, shared_of(world)); !good && good.error() != fault_)
    sentences.push_back("It cannot be simulated: " + good.error());
  for (const std::string& mended : described->mesh.mended) sentences.push_back("Its mesh was mended: " + mended);
  return sentences;
}

void Cloth::started(const weft::RenderMesh& mesh, const Variant& texture, std::uint32_t first_vertex) {
  fault_.clear();
  drawn_.reset();
  const auto path = reinterpret_cast<GDExtensionInterfaceGetLibraryPath>(godot::function("get_library_path"));
  void* text = nullptr;
  path(godot::library(), &text);
  std::string folder = Variant::of(GDEXTENSION_VARIANT_TYPE_STRING, &text).call("get_base_dir").to_string();
  drawn_ = std::make_unique<Drawn>(self(), mesh, texture, first_vertex, folder);
  call("emit_signal", godot::name("started"));
}

void Cloth::stopped() { drawn_.reset(); }

void Cloth::failed(const std::string& sentence) {
  if (fault_ == sentence) return;
  fault_ = sentence;
  drawn_.reset();
  const std::string where = call("is_inside_tree").to_bool() ? call("get_path").to_string() : call("get_name").to_string();
  godot::print_warning("Weft: the cloth " + where + " stands still: " + sentence);
  call("emit_signal", godot::name("failed"), sentence);
}

void Cloth::restart() {
  if (stage_ != nullptr) stage_->restart(*this);
}

std::vector<weft::Vec3> Cloth::vertices() { return stage_ != nullptr ? stage_->vertices(*this) : std::vector<weft::Vec3>(); }

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
    std::vector<Property> own;
    own.push_back(property(
        "world", GDEXTENSION_VARIANT_TYPE_OBJECT, Hint::resource, "WeftWorld",
        "Solver, contacts and air, which cloths share. Those without one share a world with the defaults.", [](CC& c) { return c.world; },
        [](C& c, const Variant& v) { c.world = v; }));
    own.back().type_name = "WeftWorld";
    own.push_back(property(
        "gltf", GDEXTENSION_VARIANT_TYPE_STRING, Hint::file, "*.glb,*.gltf,*.obj",
        "A file to read the cloth's mesh from, in place of the node's: with vertex groups as custom attributes (_NAME). Its material "
        "is the node's material override. It must lie on the disk, so that it is not there in an exported package.",
        [](CC& c) { return c.gltf; }, [](C& c, const Variant& v) { c.gltf = v.to_string(); }));
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
          const int next = static_cast<int>(std::clamp<std::int64_t>(v.to_int(), 0, kOwn));
          if (next == kOwn && c.preset != kOwn && in_editor()) c.own_fabric = c.fabric();
          c.preset = next;
          c.call("notify_property_list_changed");
        });
    preset.updates_all = true;
    fabric.push_back(preset);
    const std::function<weft::Fabric&(Instance&)> figures = [](Instance& at) -> weft::Fabric& { return cloth_in(at).own_fabric; };
    for (Property& figure : properties_of("fabric_", "fabric", figures, {"preset"})) fabric.push_back(std::move(figure));
    const std::function<weft::Maps&(Instance&)> maps = [](Instance& at) -> weft::Maps& { return cloth_in(at).maps; };
    return godot::Class{
        "WeftCloth3D",
        "MeshInstance3D",
        "Cloth, simulated by Weft on the GPU on which Godot draws.",
        "The node's mesh is cloth: it starts where the node is, is held by the WeftAnchor3D nodes below it, and meets the collision shapes "
        "of the tree. The "
        "node's transform says where it starts, and moves anchors that follow nothing else; the cloth itself goes where physics takes it. "
        "It stops with the "
        "tree's pause, slows with Engine.time_scale, and lies between ticks where the project interpolates physics. In the editor it is "
        "shown at rest.",
        {{"Cloth", "", own}, {"Fabric", "fabric_", fabric}, {"Maps", "maps_", properties_of("maps_", "maps", maps)}},
        {{"get_fault",
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
          }}},
        {{"started", {}, "It is simulated from now on, or again."},
         {"failed", {{"sentence", GDEXTENSION_VARIANT_TYPE_STRING}}, "It stands still, and why."}},
        [](godot::Object self) -> Instance* { return new Cloth(self); }};
  }();
  return described;
}

}  // namespace weft_godot
