// See samples/godot/cloth.h.
#include "samples/godot/cloth.h"

#include <algorithm>
#include <numbers>

#include "samples/godot/meshes.h"
#include "samples/godot/poses.h"
#include "samples/godot/stage.h"

namespace weft_godot {
namespace {

using godot::Variant;
using weft::fail;
using weft::Result;

// Node::NOTIFICATION_*
enum Notification { kEnterTree = 10, kExitTree = 11, kInternalPhysics = 26 };

constexpr int kLast = 1 << 20;   // of priorities: after all that moves

bool in_editor() { return godot::singleton("Engine").call("is_editor_hint").to_bool(); }

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
  const auto is_hidden = [&](std::string_view prefix, std::string_view always, bool shown) {
    return !shown && property.starts_with(prefix) && property != always;
  };
  return !is_hidden("fabric_", "fabric_preset", preset == kOwn) && !is_hidden("motion_", "motion_enabled", has_motion) &&
         !is_hidden("inertia_", "inertia_enabled", has_inertia) && !is_hidden("pressure_", "pressure_enabled", has_gas) &&
         !is_hidden("tear_", "tear_enabled", has_tear) && !is_hidden("mesh", "", gltf_.empty());
}

bool Cloth::saves(std::string_view property) const { return property != "mesh" || gltf_.empty(); }

weft::Fabric Cloth::fabric() const {
  if (preset == kOwn) return own_fabric;
  const std::optional<weft::Fabric> named = weft::fabric_preset(kPresets[preset]);
  return named ? *named : weft::Fabric{};
}

Result<weft::Mesh> Cloth::mesh() const {
  if (file_) return *file_;
  return mesh_of(call("get_mesh"));
}

void Cloth::set_gltf(const std::string& path) {
  const bool had_file = !gltf_.empty();
  gltf_ = path;
  file_.reset();
  if (!path.empty()) file_ = weft::load_mesh(on_disk(path));
  std::vector<std::uint32_t> surfaces;
  if (file_ && *file_) call("set_mesh", drawn_mesh((*file_)->render, surfaces));
  else if (had_file) call("set_mesh", Variant());
}

Result<Cloth::Described> Cloth::describe(std::optional<godot::Transform> start) const {
  Described described;
  auto own = mesh();
  if (!own) return own.take_error();
  described.mesh = std::move(*own);
  const bool is_in_tree = call("is_inside_tree").to_bool();
  const godot::Transform at = start ? *start : is_in_tree ? call("get_global_transform").to_transform() : godot::Transform{};
  described.start = at;
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
    if (!anchor->with_skin) cloth.anchors.back().keys = {weft::Key{}};
    described.anchors.push_back(anchor);
  }
  if (has_gas) cloth.pressure = gas;
  if (has_tear) cloth.tear = tear;
  if (has_motion) cloth.motion_constraints = motion;
  if (has_inertia) cloth.inertia = inertia, cloth.inertia->joint = Skin::kOfNode;
  const bool goes_with_skin = has_motion || has_inertia || std::ranges::any_of(described.anchors, &Anchor::with_skin);
  if (goes_with_skin) {
    described.skin = Skin::bind(self(), at, has_inertia, described.mesh, described.fault);
    cloth.skin = weft::Skinning{};
  } else {
    described.mesh.skin.reset();
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
  if (!described->fault.empty()) sentences.push_back(described->fault);
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

void Cloth::torn(const weft::RenderMesh& mesh) {
  if (drawn_) drawn_->reshape(mesh);
  call("emit_signal", godot::name("torn"));
}

void Cloth::act(Hand hand) {
  if (stage_ != nullptr) stage_->act(*this, std::move(hand));
}

Variant Cloth::grab(weft::Vec3 origin, weft::Vec3 direction) {
  const Variant answer = Variant::empty(GDEXTENSION_VARIANT_TYPE_DICTIONARY);
  if (stage_ == nullptr) return answer;
  const auto grabbed = stage_->grab(origin, direction, grip);
  if (!grabbed) godot::print_warning("Weft: " + grabbed.error());
  if (!grabbed || !*grabbed) return answer;
  const Hands::Held& held = (*grabbed)->held;
  answer.call("set", "grab", held.number);
  answer.call("set", "cloth", (*grabbed)->cloth);
  answer.call("set", "point", held.at.point);
  answer.call("set", "distance", held.at.distance);
  return answer;
}

std::uint32_t Cloth::cut(weft::Vec3 origin, weft::Vec3 a, weft::Vec3 b) {
  if (stage_ == nullptr) return 0;
  const auto count = stage_->cut(origin, a, b);
  if (!count) godot::print_warning("Weft: " + count.error());
  return count ? *count : 0;
}

void Cloth::restart() {
  if (stage_ != nullptr) stage_->restart(*this);
}

std::vector<weft::Vec3> Cloth::vertices() { return stage_ != nullptr ? stage_->vertices(*this) : std::vector<weft::Vec3>(); }

}  // namespace weft_godot
