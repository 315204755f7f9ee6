// A class of this plug-in, described as data: what the inspector shows, what scripts call, and what the editor's help says of it.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "samples/godot/godot.h"

namespace godot {

/// What Godot calls PROPERTY_HINT_* and PROPERTY_USAGE_*.
enum class Hint : std::uint32_t {
  none = 0,
  range = 1,
  choice = 2,
  layers_3d_physics = 11,
  file = 13,
  folder = 14,
  resource = 17,
  types = 23,   // of an array's elements
  node = 26
};
constexpr std::uint32_t kStored = 2, kEdited = 4, kUpdatesAll = 1u << 14;

/// What every object of ours is, behind Godot's.
class Instance {
 public:
  explicit Instance(Object self) : self_(self) {}
  virtual ~Instance() = default;
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  Object self() const { return self_; }
  Variant call(std::string_view method, const auto&... arguments) const { return Variant(self_).call(method, arguments...); }

  virtual void notified(int) {}
  /// Sentences that the tree shows beside the node.
  virtual std::vector<std::string> warnings() { return {}; }
  /// Whether a property is shown now.
  virtual bool shows(std::string_view) const { return true; }
  /// Whether a property of a parent's is saved now.
  virtual bool saves(std::string_view) const { return true; }

 private:
  Object self_;
};

struct Property {
  std::string name;
  Type type = GDEXTENSION_VARIANT_TYPE_FLOAT;
  Hint hint = Hint::none;
  std::string hint_text;
  std::string help;
  std::function<Variant(const Instance&)> get;
  std::function<void(Instance&, const Variant&)> set;
  bool updates_all = false;     // others are shown by its value
  std::string type_name = {};   // of objects: the class
  bool stored = true;
};
/// Properties that follow, up to the next group, have this heading; their names are shown without the prefix.
struct Group {
  std::string name, prefix;
  std::vector<Property> properties;
};

struct Argument {
  std::string name;
  Type type;
};
struct Method {
  std::string name;
  std::vector<Argument> arguments;
  Type result = GDEXTENSION_VARIANT_TYPE_NIL;   // nil: none
  std::string help;
  std::function<Variant(Instance&, std::span<const Variant>)> run;
  bool gives_any = false;   // whatever there is, without a type
};
struct Signal {
  std::string name;
  std::vector<Argument> arguments;
  std::string help;
};

struct Class {
  std::string name, parent;
  std::string brief, description;
  std::vector<Group> groups;
  std::vector<Method> methods;
  std::vector<Signal> signals;
  std::function<Instance*(Object)> create;
};

/// Makes a class known to Godot; `described` must live until unregister_classes().
void register_class(const Class& described);
void unregister_classes();
/// The instance of ours behind an object; null where it is of another class.
Instance* instance_of(Object object);
/// The help of all registered classes, as the editor reads it: tooltips of the inspector come from there.
std::string help_of_classes();

}  // namespace godot
