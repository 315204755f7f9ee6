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

extern template std::vector<godot::Property> properties_of(const std::string&, const std::string&,
                                                           std::function<weft::Fabric&(godot::Instance&)>, std::vector<std::string>);
extern template std::vector<godot::Property> properties_of(const std::string&, const std::string&,
                                                           std::function<weft::SolverSettings&(godot::Instance&)>,
                                                           std::vector<std::string>);
extern template std::vector<godot::Property> properties_of(const std::string&, const std::string&,
                                                           std::function<weft::Contacts&(godot::Instance&)>, std::vector<std::string>);
extern template std::vector<godot::Property> properties_of(const std::string&, const std::string&,
                                                           std::function<weft::Maps&(godot::Instance&)>, std::vector<std::string>);
extern template std::vector<godot::Property> properties_of(const std::string&, const std::string&,
                                                           std::function<weft::Air&(godot::Instance&)>, std::vector<std::string>);

}  // namespace weft_godot
