// See samples/godot/world.h.
#include "samples/godot/world.h"

#include <algorithm>

#include "samples/godot/air.h"
#include "samples/godot/fields.h"
#include "samples/godot/simulated.h"

namespace weft_godot {
namespace {

using godot::Group;
using godot::Hint;
using godot::Instance;
using godot::Property;
using godot::Variant;

World& world_in(Instance& instance) { return static_cast<World&>(instance); }

std::vector<weft::Air::Gust> gusts_in(const Variant& list) {
  std::vector<weft::Air::Gust> gusts;
  const std::int64_t count = list.type() == GDEXTENSION_VARIANT_TYPE_ARRAY ? list.call("size").to_int() : 0;
  for (std::int64_t k = 0; k < count; ++k)
    if (const auto* gust = dynamic_cast<const Gust*>(godot::instance_of(list.call("get", k).to_object()))) gusts.push_back(gust->gust);
  return gusts;
}

// How many of something a script may hold at a time.
Property room(std::string name, std::uint32_t most, std::string help, std::uint32_t World::*at) {
  return {std::move(name),
          GDEXTENSION_VARIANT_TYPE_INT,
          Hint::range,
          "0," + std::to_string(most) + ",1",
          std::move(help),
          [at](const Instance& instance) { return Variant(static_cast<const World&>(instance).*at); },
          [at, most](Instance& instance, const Variant& value) {
            world_in(instance).*at = static_cast<std::uint32_t>(std::clamp<std::int64_t>(value.to_int(), 0, most));
          }};
}

}  // namespace

bool World::shows(std::string_view property) const { return has_air || !property.starts_with("air_") || property == "air_enabled"; }

Shared shared_of(const Variant& world) {
  const auto* resource = dynamic_cast<const World*>(godot::instance_of(world.to_object()));
  if (resource == nullptr) return {};
  Shared shared{resource->solver,        resource->contacts, resource->has_air ? std::optional(resource->air) : std::nullopt,
                resource->gravity_scale, resource->pins,     resource->grabs,
                resource->recording};
  if (shared.air) shared.air->gusts = gusts_in(resource->gusts);
  return shared;
}

const godot::Class& world_class() {
  static const godot::Class described = [] {
    Property gravity{"gravity_scale",
                     GDEXTENSION_VARIANT_TYPE_FLOAT,
                     Hint::range,
                     "-10,10,0.001,or_less,or_greater",
                     "What the project's gravity (physics/3d/default_gravity) is multiplied by.",
                     [](const Instance& at) { return Variant(static_cast<const World&>(at).gravity_scale); },
                     [](Instance& at, const Variant& value) { world_in(at).gravity_scale = value.to_double(); }};
    Property recording{
        "recording",
        GDEXTENSION_VARIANT_TYPE_STRING,
        Hint::folder,
        "",
        "A folder, res:// or user:// or of the disk. When the simulation ends, what ran is left there as a scene for weft run: the "
        "meshes, and the way of everything that moved them, tick by tick. Empty: nothing is recorded.",
        [](const Instance& at) { return Variant(static_cast<const World&>(at).recording); },
        [](Instance& at, const Variant& value) { world_in(at).recording = value.to_string(); }};
    Property enabled{"air_enabled",
                     GDEXTENSION_VARIANT_TYPE_BOOL,
                     Hint::none,
                     "",
                     "Whether there is air, which resists cloth, and in which there may be a wind.",
                     [](const Instance& at) { return Variant(static_cast<const World&>(at).has_air); },
                     [](Instance& at, const Variant& value) {
                       world_in(at).has_air = value.to_bool();
                       at.call("notify_property_list_changed");
                     },
                     true};
    const std::function<weft::SolverSettings&(Instance&)> solver = [](Instance& at) -> weft::SolverSettings& {
      return world_in(at).solver;
    };
    const std::function<weft::Contacts&(Instance&)> contacts = [](Instance& at) -> weft::Contacts& { return world_in(at).contacts; };
    const std::function<weft::Air&(Instance&)> air = [](Instance& at) -> weft::Air& { return world_in(at).air; };
    Property gusts{"air_gusts",
                   GDEXTENSION_VARIANT_TYPE_ARRAY,
                   Hint::types,
                   "24/17:WeftGust",   // objects, resources
                   "What comes on top of the wind and goes again, 8 at most. Fields of the air are nodes, WeftAirField3D.",
                   [](const Instance& at) {
                     const Variant& list = static_cast<const World&>(at).gusts;
                     return list.type() == GDEXTENSION_VARIANT_TYPE_ARRAY ? list : Variant::empty(GDEXTENSION_VARIANT_TYPE_ARRAY);
                   },
                   [](Instance& at, const Variant& value) { world_in(at).gusts = value; }};
    Group of_air{"Air", "air_", {enabled}};
    for (Property& property : properties_of("air_", "air", air)) of_air.properties.push_back(std::move(property));
    of_air.properties.push_back(gusts);
    const std::vector<Property> hands{
        room("pins", weft::kMostPins, "How many vertices scripts may pin at a time (WeftCloth3D.pin). 0: none, nor release any.",
             &World::pins),
        room("grabs", weft::kMostGrabs, "How many places of cloth scripts may pull at a time (WeftCloth3D.grab).", &World::grabs)};
    return godot::Class{
        "WeftWorld",
        "Resource",
        "What WeftCloth3D nodes share: solver, contacts and air.",
        "Cloths that name the same WeftWorld are one simulation, and meet each other where contacts are enabled. The wind may be changed "
        "while it runs; of other values a simulation takes notice when it is made anew: when a cloth comes or goes.",
        {{"World", "", {gravity, recording}},
         {"Hands", "", hands},
         {"Solver", "solver_", properties_of("solver_", "solver", solver)},
         {"Contacts", "contacts_", properties_of("contacts_", "contacts", contacts)},
         of_air},
        {{"get_simulation_count",
          {},
          GDEXTENSION_VARIANT_TYPE_INT,
          "How many simulations there are on the GPU, of all worlds.",
          [](Instance&, std::span<const Variant>) { return Variant(Simulated::alive()); }}},
        {},
        [](godot::Object self) -> Instance* { return new World(self); }};
  }();
  return described;
}

}  // namespace weft_godot
