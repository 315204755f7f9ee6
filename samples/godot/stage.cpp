// See samples/godot/stage.h.
#include "samples/godot/stage.h"

#include <algorithm>
#include <cmath>

#include "samples/godot/air.h"

namespace weft_godot {
namespace {

using godot::Box;
using godot::Variant;
using weft::Vec3;

// Runs on the render thread: at once where that is this thread, as it is by default.
void on_render_thread(std::function<void()> work) {
  const Variant server = godot::singleton("RenderingServer");
  server.call("call_on_render_thread", godot::callable([work = std::move(work)](std::span<const Variant>) { work(); }));
}

Vec3 gravity_of_project() {
  const Variant settings = godot::singleton("ProjectSettings");
  const double strength = settings.call("get_setting", "physics/3d/default_gravity", 9.8).to_double();
  return float(strength) * settings.call("get_setting", "physics/3d/default_gravity_vector", Vec3{0, -1, 0}).to_vector3();
}

constexpr std::size_t kMostFields = 16;   // of a scene's air (engine/scene.h)

float longest(Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

std::vector<std::unique_ptr<Stage>>& Stage::all() {
  static std::vector<std::unique_ptr<Stage>> stages;
  return stages;
}

Stage& Stage::of(const Variant& world) {
  const std::uint64_t id = godot::id_of(world.to_object());
  for (const auto& stage : all())
    if (godot::id_of(stage->world_.to_object()) == id) return *stage;
  return *all().emplace_back(std::make_unique<Stage>(world));
}

void Stage::shapes_changed() {
  for (const auto& stage : all()) stage->is_dirty_ = true;
}

void Stage::air_changed(std::uint64_t world) {
  for (const auto& stage : all())
    if (godot::id_of(stage->world_.to_object()) == world) stage->is_dirty_ = true;
}

void Stage::before_drawing() {
  on_render_thread([] { destroy_given_up(false); });
  for (const auto& stage : all()) stage->present();
}

void Stage::end_all() {
  all().clear();
  on_render_thread([] { destroy_given_up(true); });
  godot::singleton("RenderingServer").call("force_sync");
}

Stage::~Stage() {
  for (Member& member : members_) member.cloth->stopped();
  set_texture({});
  if (simulated_) on_render_thread([simulated = simulated_] { simulated->end(); });
}

void Stage::add(Cloth& cloth) {
  Member member{};
  member.cloth = &cloth;
  members_.push_back(std::move(member));
  is_dirty_ = true;
}

void Stage::remove(Cloth& cloth) {
  cloth.stopped();
  std::erase_if(members_, [&](const Member& member) { return member.cloth == &cloth; });
  std::erase_if(hands_, [&](const auto& hand) { return hand.first == &cloth; });
  is_dirty_ = true;
  if (!members_.empty()) return;
  std::erase_if(all(), [this](const auto& stage) { return stage.get() == this; });   // this is gone now
}

void Stage::restart(Cloth& cloth) {
  for (Member& member : members_)
    if (member.cloth == &cloth) member.place.reset();
  is_dirty_ = true;
}

void Stage::give_up(const std::string& sentence) {
  hands_.clear();
  set_texture({});
  for (Member& member : members_) {
    member.is_shown = false;
    if (member.place) member.cloth->failed(sentence);
  }
}

void Stage::make() {
  is_dirty_ = false;
  const Shared shared = shared_of(world_);
  Setup setup;
  weft::Scene& scene = setup.scene;
  scene.solver = shared.solver;
  scene.contacts = shared.contacts;
  scene.air = shared.air;
  scene.pins = shared.pins;
  scene.grabs = shared.grabs;
  scene.gravity = float(shared.gravity_scale) * gravity_of_project();
  wind_ = shared.air ? shared.air->wind : Vec3{};
  if (!shared.recording.empty()) setup.recording = godot::singleton("ProjectSettings").call("globalize_path", shared.recording).to_string();

  std::vector<Cloth*> cloths;
  for (Member& member : members_) {
    const std::optional<std::uint32_t> before = member.place;
    member.place.reset();
    member.is_shown = false;
    auto described = member.cloth->describe(before ? std::optional(member.start) : std::nullopt);
    // A cloth that goes on keeps its state, what its anchors hold, and what these have moved since it began.
    const bool goes_on = before && described && described->anchors.size() == member.anchors.size();
    if (goes_on) described->cloth.anchors = member.choices;
    weft::Result<void> good = described ? Cloth::check_alone(*described, shared) : weft::Result<void>(weft::Error{described.error()});
    if (!good) {
      member.cloth->failed(good.error());
      continue;
    }
    described->cloth.name.append(1, ' ').append(std::to_string(cloths.size()));   // colliders name the cloths that they meet
    std::vector<std::pair<std::uint64_t, godot::Transform>> anchors;
    for (const Anchor* anchor : described->anchors) {
      const auto at = anchor->followed();
      const auto back = at ? inverse(*at) : std::nullopt;
      anchors.emplace_back(godot::id_of(anchor->self()), back.value_or(godot::Transform{}));
    }
    if (!goes_on) member.anchors = anchors, member.moved.assign(anchors.size(), {}), member.choices = described->cloth.anchors;
    member.start = described->start;
    member.skin = std::move(described->skin);
    member.gas = 1;
    if (const auto& constraints = described->cloth.motion_constraints) member.motion = {1, constraints->stiffness};
    member.place = static_cast<std::uint32_t>(cloths.size());
    member.box_of_tick = 0;
    setup.carried.push_back(before);
    scene.cloths.push_back(std::move(described->cloth));
    setup.meshes.push_back(std::move(described->mesh));
    cloths.push_back(member.cloth);
  }
  if (cloths.empty()) {
    hands_.clear();
    set_texture({});
    if (simulated_) on_render_thread([simulated = simulated_] { simulated->end(); });
    return;
  }
  add_shapes(scene, setup.meshes, cloths);
  add_fields(scene);
  if (auto good = weft::check(scene); !good) return give_up(good.error());
  moment_ = drawn_ = {};
  ticks_ = 1;
  torn_in_tick_ = 0;
  if (!simulated_) simulated_ = std::make_shared<Simulated>();
  setup.number = ++setups_;
  auto given = std::make_shared<Setup>(std::move(setup));
  drawn_meshes_.clear();
  for (std::size_t k = 0; k < cloths.size(); ++k) drawn_meshes_.push_back(given->meshes[k].render);
  on_render_thread([simulated = simulated_, given] { simulated->make(std::move(*given)); });
}

void Stage::add_shapes(weft::Scene& scene, std::vector<weft::Mesh>& meshes, const std::vector<Cloth*>& cloths) {
  std::vector<std::string> faults;
  const Variant root = cloths[0]->call("get_tree").call("get_root");
  shapes_ = shapes_below(root, resized_, faults);
  std::erase_if(shapes_, [&](const Shape& shape) {
    return std::ranges::none_of(cloths, [&](const Cloth* cloth) { return (cloth->collision_mask & shape.layers()) != 0; });
  });
  for (const Shape& shape : shapes_) {
    weft::Collider collider = shape.collider();
    std::vector<std::string> met;
    for (std::size_t c = 0; c < cloths.size(); ++c)
      if ((cloths[c]->collision_mask & shape.layers()) != 0) met.push_back(scene.cloths[c].name);
    if (met.size() != cloths.size()) collider.meets = std::move(met);
    scene.colliders.push_back(std::move(collider));
    if (shape.mesh()) meshes.push_back(*shape.mesh());
  }
  for (const std::string& fault : faults)
    if (told_.insert(fault).second) godot::print_warning("Weft: " + fault);
}

void Stage::move_shapes(Tick& tick) {
  for (std::uint32_t k = 0; k < shapes_.size(); ++k) {
    const Shape::Change change = shapes_[k].look();
    tick.colliders.push_back(change.key);
    if (change.at_once) tick.placed.push_back(k);
    if (change.size) tick.resized.emplace_back(k, *change.size);
    if (!shapes_[k].is_outdated()) continue;
    resized_.insert(shapes_[k].node());
    is_dirty_ = true;
  }
}

void Stage::add_fields(weft::Scene& scene) {
  fields_.clear();
  if (!scene.air) return;
  for (const AirField* field : AirField::all()) {
    if (field->world_id() != godot::id_of(world_.to_object())) continue;
    if (fields_.size() == kMostFields) {
      const std::string fault = "the air of a world has 16 fields at most: " + field->call("get_path").to_string() + " is left out.";
      if (told_.insert(fault).second) godot::print_warning("Weft: " + fault);
      continue;
    }
    fields_.emplace_back(godot::id_of(field->self()), field->described());
    scene.air->fields.push_back(fields_.back().second);
  }
}

void Stage::move_cloths(Tick& tick) {
  tick.cloths.resize(drawn_meshes_.size());
  for (Member& member : members_) {
    if (!member.place) continue;
    ClothTick& now = tick.cloths[*member.place];
    move_anchors(member, now);
    if (member.skin) now.bones = member.skin->look();
    const Cloth& cloth = *member.cloth;
    if (cloth.has_gas && cloth.gas_amount != member.gas) now.gas = member.gas = cloth.gas_amount;
    const ClothTick::Motion motion{cloth.motion_scale, cloth.motion.stiffness};
    if (cloth.has_motion && !(motion == member.motion)) now.motion = member.motion = motion;
  }
  for (auto& [cloth, hand] : hands_)
    for (const Member& member : members_)
      if (member.cloth == cloth && member.place) {
        hand.cloth = *member.place;
        tick.hands.push_back(std::move(hand));
      }
  hands_.clear();
}

void Stage::move_anchors(Member& member, ClothTick& tick) {
  for (std::size_t k = 0; k < member.anchors.size(); ++k) {
    const auto* anchor = dynamic_cast<const Anchor*>(godot::instance_of(godot::object_of(member.anchors[k].first)));
    const auto at = anchor ? anchor->followed() : std::nullopt;
    if (!at) continue;   // it is gone: what it held stays where it was
    if (const auto moved = placed(*at * member.anchors[k].second)) member.moved[k] = *moved;
  }
  tick.anchors = member.moved;
}

void Stage::move_air(Tick& tick) {
  const Shared shared = shared_of(world_);
  if (shared.air && !(shared.air->wind == wind_)) tick.wind = wind_ = shared.air->wind;
  for (std::uint32_t k = 0; k < fields_.size(); ++k) {
    const auto* field = dynamic_cast<const AirField*>(godot::instance_of(godot::object_of(fields_[k].first)));
    if (field == nullptr) continue;
    weft::Air::Field now = fields_[k].second;
    const weft::Air::Field described = field->described();
    now.centre = described.centre, now.velocity = described.velocity;
    if (now == fields_[k].second) continue;
    fields_[k].second = now;
    tick.fields.emplace_back(k, now);
  }
}

// None of those that are drawn, or were in the frame before, or lie behind the newest.
std::uint32_t Stage::free_slot() const {
  std::uint32_t slot = 0;
  while (slot == moment_.newest || slot == drawn_.before || slot == drawn_.newest) ++slot;
  return slot;
}

void Stage::tick(double seconds) {
  const std::int64_t now = godot::singleton("Engine").call("get_physics_frames").to_int();
  if (now == ticked_) return;
  ticked_ = now;
  if (is_dirty_) make();
  if (!simulated_) return;
  const Seen seen = simulated_->seen();
  look(seen);
  if (seen.setup != setups_ || !seen.is_running) return;
  Tick tick;
  tick.seconds = seconds;
  move_shapes(tick);
  move_cloths(tick);
  move_air(tick);
  tick.slot = free_slot();
  moment_ = {moment_.newest, tick.slot, 1};
  ++ticks_;
  on_render_thread([simulated = simulated_, tick = std::make_shared<Tick>(std::move(tick))] { simulated->tick(*tick); });
}

void Stage::set_texture(godot::Rid texture) {
  if (texture.id == texture_rid_.id) return;
  if (!texture_.to_object()) texture_ = godot::make("Texture2DArrayRD");
  texture_.call("set_texture_rd_rid", texture);
  texture_rid_ = texture;
}

// What the render thread has come to.
void Stage::look(const Seen& seen) {
  if (seen.setup != setups_) return;   // the last but one
  if (!seen.failure.empty()) return give_up(seen.failure);
  if (!seen.is_running) return;
  set_texture(seen.texture);
  const bool tore = seen.torn_in_tick != torn_in_tick_;
  torn_in_tick_ = seen.torn_in_tick;
  for (Member& member : members_) {
    if (!member.place) continue;
    if (tore && seen.torn[*member.place]) {
      drawn_meshes_[*member.place] = *seen.torn[*member.place];
      if (member.is_shown) member.cloth->torn(drawn_meshes_[*member.place]);
    }
    if (!member.is_shown) {
      member.cloth->started(drawn_meshes_[*member.place], texture_, seen.first_vertices[*member.place]);
      member.box = {};
      member.is_shown = true;
    }
    if (seen.boxes.size() <= *member.place || member.box_of_tick == seen.boxes_of_tick) continue;
    const Box& box = seen.boxes[*member.place];
    const float ticks = float(seen.boxes_of_tick - member.box_of_tick);
    const Vec3 low = box.low - member.box.low, high = low + box.size - member.box.size;
    member.speed = member.box_of_tick == 0 ? Vec3{} : (std::max(longest(low), longest(high)) / ticks) * Vec3{1, 1, 1};
    member.box = box;
    member.box_of_tick = seen.boxes_of_tick;
  }
}

// The box is some ticks old: it grows by twice as far as it has moved in as many.
void Stage::present() {
  if (!simulated_) return;
  look(simulated_->seen());
  const double fraction = godot::singleton("Engine").call("get_physics_interpolation_fraction").to_double();
  for (Member& member : members_) {
    if (!member.is_shown || member.cloth->drawn() == nullptr) continue;
    const bool is_between = member.cloth->call("is_physics_interpolated_and_enabled").to_bool();
    const float old = float(ticks_ - member.box_of_tick + 1);
    const Vec3 margin = 2 * old * member.speed + Vec3{0.05f, 0.05f, 0.05f};
    Moment moment = moment_;
    if (torn_in_tick_ == ticks_) moment.before = moment.newest;   // before, what is new was nowhere
    moment.between = is_between ? float(std::clamp(fraction, 0.0, 1.0)) : 1;
    member.cloth->drawn()->present(moment, {member.box.low - margin, member.box.size + 2 * margin});
  }
  drawn_ = moment_;
}

std::vector<Vec3> Stage::vertices(const Cloth& cloth) {
  auto found = std::make_shared<std::vector<Vec3>>();
  for (const Member& member : members_) {
    if (member.cloth != &cloth || !member.place || !simulated_) continue;
    on_render_thread([simulated = simulated_, found, place = *member.place] {
      if (auto read = simulated->read_vertices(place)) *found = std::move(*read);
    });
    godot::singleton("RenderingServer").call("force_sync");
  }
  return *found;
}

weft::Result<std::optional<Stage::Grabbed>> Stage::grab(Vec3 origin, Vec3 direction, const weft::Grip& grip) {
  if (!simulated_) return weft::fail("the cloth is not simulated yet");
  using Found = weft::Result<std::optional<Hands::Held>>;
  auto found = std::make_shared<Found>(std::optional<Hands::Held>());
  on_render_thread([simulated = simulated_, found, origin, direction, grip] { *found = simulated->grab(origin, direction, grip); });
  godot::singleton("RenderingServer").call("force_sync");
  if (!*found) return found->why();
  if (!**found) return std::optional<Grabbed>();
  for (const Member& member : members_)
    if (member.place && *member.place == (**found)->at.cloth) return std::optional(Grabbed{***found, member.cloth->self()});
  return std::optional<Grabbed>();
}

weft::Result<std::uint32_t> Stage::cut(Vec3 origin, Vec3 a, Vec3 b) {
  if (!simulated_) return weft::fail("the cloth is not simulated yet");
  auto count = std::make_shared<weft::Result<std::uint32_t>>(0u);
  on_render_thread([simulated = simulated_, count, origin, a, b] { *count = simulated->cut(origin, a, b); });
  godot::singleton("RenderingServer").call("force_sync");
  return std::move(*count);
}

}  // namespace weft_godot
