// Weft's own table of fields (engine/scene/fields.h) as properties: names, units, ranges and choices come from there, what the editor says
// of them from the scene's schema. A field that is added to Weft is in the inspector with the next build.
#pragma once

#include "engine/scene.h"
#include "samples/godot/classes.h"

namespace weft_godot {

/// The fields of a struct of a scene, as properties PREFIX_KEY. `at` says where in an instance the struct is. Lists and objects in it are
/// left out, and the keys that are named.
template <class T>
std::vector<godot::Property> properties_of(const std::string& prefix, const std::string& schema, std::function<T&(godot::Instance&)> at,
                                           std::vector<std::string> without = {});

#define WEFT_GODOT_FIELDS(T)                                                                                                       \
  template std::vector<godot::Property> properties_of(const std::string&, const std::string&, std::function<T&(godot::Instance&)>, \
                                                      std::vector<std::string>)
extern WEFT_GODOT_FIELDS(weft::Fabric);
extern WEFT_GODOT_FIELDS(weft::Maps);
extern WEFT_GODOT_FIELDS(weft::MotionConstraints);
extern WEFT_GODOT_FIELDS(weft::Inertia);
extern WEFT_GODOT_FIELDS(weft::Gas);
extern WEFT_GODOT_FIELDS(weft::Tear);
extern WEFT_GODOT_FIELDS(weft::SolverSettings);
extern WEFT_GODOT_FIELDS(weft::Contacts);
extern WEFT_GODOT_FIELDS(weft::Air);
extern WEFT_GODOT_FIELDS(weft::Air::Gust);
extern WEFT_GODOT_FIELDS(weft::Air::Field);

}  // namespace weft_godot
