// See samples/godot/air.h.
#include "samples/godot/air.h"

#include <algorithm>

#include "samples/godot/fields.h"
#include "samples/godot/poses.h"
#include "samples/godot/stage.h"

namespace weft_godot {
namespace {

using godot::Hint;
using godot::Instance;
using godot::Property;
using godot::Variant;
using FieldShape = weft::Air::Field::Shape;

enum Notification { kEnterTree = 10, kExitTree = 11 };   // Node::NOTIFICATION_*

std::vector<AirField*>& fields_in_tree() {
  static std::vector<AirField*> all;
  return all;
}

}  // namespace

AirField::~AirField() { leave(); }

const std::vector<AirField*>& AirField::all() { return fields_in_tree(); }

void AirField::leave() {
  if (std::erase(fields_in_tree(), this) > 0) Stage::air_changed(world_id());
}

void AirField::notified(int what) {
  if (what == kEnterTree) {
    call("update_configuration_warnings");
    if (godot::singleton("Engine").call("is_editor_hint").to_bool()) return;
    fields_in_tree().push_back(this);
    Stage::air_changed(world_id());
  }
  if (what == kExitTree) leave();
}

weft::Air::Field AirField::described() const {
  weft::Air::Field now = field;
  const auto place = call("is_inside_tree").to_bool() ? placed(call("get_global_transform").to_transform()) : std::nullopt;
  if (!place) return now;
  now.centre = place->at;
  now.velocity = call("is_visible_in_tree").to_bool() ? weft::rotated(place->rotation, field.velocity) : weft::Vec3{};
  return now;
}

bool AirField::shows(std::string_view property) const {
  const bool is_box = field.shape == FieldShape::box;
  if (property == "size") return is_box;
  if (property == "radius") return !is_box;
  return property != "falloff" || is_box || field.shape == FieldShape::sphere;
}

std::vector<std::string> AirField::warnings() {
  std::vector<std::string> sentences;
  if (field.velocity == weft::Vec3{}) sentences.push_back("Its air does not move: set its velocity.");
  if (call("is_inside_tree").to_bool() && !placed(call("get_global_transform").to_transform()))
    sentences.push_back("Its node is mirrored, sheared or of no size: the field stands at the origin.");
  if (!shared_of(world).air) sentences.push_back("Its WeftWorld has no air: enable it.");
  return sentences;
}

const godot::Class& gust_class() {
  static const godot::Class described = [] {
    const std::function<weft::Air::Gust&(Instance&)> gust = [](Instance& at) -> weft::Air::Gust& { return static_cast<Gust&>(at).gust; };
    return godot::Class{"WeftGust",
                        "Resource",
                        "A gust in the air of a WeftWorld.",
                        "It comes on top of the wind, everywhere at once, and swings between its velocity and the opposite.",
                        {{"Gust", "", properties_of("", "gust", gust)}},
                        {},
                        {},
                        [](godot::Object self) -> Instance* { return new Gust(self); }};
  }();
  return described;
}

const godot::Class& air_field_class() {
  static const godot::Class described = [] {
    Property world{"world",
                   GDEXTENSION_VARIANT_TYPE_OBJECT,
                   Hint::resource,
                   "WeftWorld",
                   "Whose air it is in. Empty: that of cloths without a world.",
                   [](const Instance& at) { return static_cast<const AirField&>(at).world; },
                   [](Instance& at, const Variant& value) {
                     auto& field = static_cast<AirField&>(at);
                     Stage::air_changed(field.world_id());
                     field.world = value;
                     Stage::air_changed(field.world_id());
                     at.call("update_configuration_warnings");
                   }};
    world.type_name = "WeftWorld";
    std::vector<Property> own{world};
    const std::function<weft::Air::Field&(Instance&)> field = [](Instance& at) -> weft::Air::Field& {
      return static_cast<AirField&>(at).field;
    };
    for (Property& property : properties_of("", "air_field", field, {"centre"})) {
      const bool is_shape = property.name == "shape";
      property.updates_all = is_shape;
      property.set = [set = property.set, is_shape](Instance& at, const Variant& value) {
        set(at, value);
        at.call("update_configuration_warnings");
        if (is_shape) at.call("notify_property_list_changed");
      };
      own.push_back(std::move(property));
    }
    return godot::Class{"WeftAirField3D",
                        "Node3D",
                        "What the air of a WeftWorld does in a part of space: a jet, a vortex, moving air in a box or a sphere.",
                        "The field is where its node is, and its velocity is along the node's axes: a jet blows from the node, a vortex "
                        "turns about it. Both are followed from tick to tick; a box keeps to the axes of the world. While the node is "
                        "hidden its air is still. Of the shape and the sizes a simulation takes notice when it is made anew.",
                        {{"Field", "", own}},
                        {},
                        {},
                        [](godot::Object self) -> Instance* { return new AirField(self); }};
  }();
  return described;
}

}  // namespace weft_godot
