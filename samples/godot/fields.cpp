// See samples/godot/fields.h.
#include "samples/godot/fields.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/scene/fields.h"
#include "scene_schema.h"   // made by CMake of assets/scene.schema.json

namespace weft_godot {
namespace {

using godot::Hint;
using godot::Property;
using godot::Variant;
using weft::scene_fields::Names;
using weft::scene_fields::Range;

constexpr godot::Type kFlag = GDEXTENSION_VARIANT_TYPE_BOOL, kWhole = GDEXTENSION_VARIANT_TYPE_INT,
                      kNumber = GDEXTENSION_VARIANT_TYPE_FLOAT, kVector = GDEXTENSION_VARIANT_TYPE_VECTOR3;

std::string in_words(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

// What Godot's sliders read. Fine steps: a fabric's flexural rigidity is 1e-5 N m.
std::string slider(const Range& range, bool whole) {
  std::string unit(range.unit);
  if (const std::size_t square = unit.find("^2"); square != std::string::npos) unit.replace(square, 2, "²");
  if (const std::size_t cube = unit.find("^3"); cube != std::string::npos) unit.replace(cube, 2, "³");
  return in_words(range.low) + "," + in_words(range.high) + "," + (whole ? "1" : "0.0000001") + ",hide_slider" +
         (unit.empty() ? "" : ",suffix:" + unit);
}

std::string listed(Names names) {
  std::string out;
  for (const std::string_view each : names) {
    if (!out.empty()) out += ',';
    out += each;
  }
  return out;
}

// A value that the table allows; the nearest where it does not.
double within(double value, const Range& range) {
  if (std::isnan(value)) return range.low;
  const double low = range.above ? std::nextafter(range.low, std::numeric_limits<double>::infinity()) : range.low;
  const double high = range.below ? std::nextafter(range.high, -std::numeric_limits<double>::infinity()) : range.high;
  return std::clamp(value, low, high);
}

const nlohmann::json& schema() {
  static const nlohmann::json read = nlohmann::json::parse(kSceneSchema, nullptr, false);
  return read;
}

std::string help_of(const std::string& object, std::string_view key) {
  const nlohmann::json& definitions = schema().is_object() ? schema().value("$defs", nlohmann::json::object()) : schema();
  if (!definitions.is_object() || !definitions.contains(object)) return "";
  const nlohmann::json properties = definitions[object].value("properties", nlohmann::json::object());
  if (!properties.contains(key)) return "";
  return properties[std::string(key)].value("description", "");
}

// The keys that can be shown, with what the inspector has to know. A visitor of the table, as are the next two.
struct List {
  std::vector<Property> found = {};

  void add(std::string_view key, godot::Type type, Hint hint = Hint::none, std::string text = "") {
    found.push_back({std::string(key), type, hint, std::move(text), {}, {}, {}});
  }
  void note(auto&&...) {}
  void text(std::string_view key, std::string&) { add(key, GDEXTENSION_VARIANT_TYPE_STRING); }
  void optional_texts(auto&&...) {}
  void flag(std::string_view key, bool&) { add(key, kFlag); }
  void optional_flag(std::string_view key, std::optional<bool>&) { add(key, kWhole, Hint::choice, "default,off,on"); }
  void number(std::string_view key, double&, const Range& range) { add(key, kNumber, Hint::range, slider(range, false)); }
  void optional_number(std::string_view key, std::optional<double>& value, const Range& range) {
    double none = 0;   // which 0 stands for
    if (range.low > 0 || (range.low == 0 && range.above)) number(key, none, {0, range.high, false, range.below, range.unit});
    (void)value;
  }
  void stiffness(std::string_view key, double& value, const Range& range) { number(key, value, range); }
  void whole(std::string_view key, std::uint32_t&, const Range& range) { add(key, kWhole, Hint::range, slider(range, true)); }
  template <class E>
  void choice(std::string_view key, E&, Names names) {
    add(key, kWhole, Hint::choice, listed(names));
  }
  void vector3(std::string_view key, weft::Vec3&, const Range& range) {
    add(key, kVector, Hint::none, range.unit.empty() ? "" : "suffix:" + std::string(range.unit));
  }
  void choices(auto&&...) {}
  void vector2(auto&&...) {}
  void direction(auto&&...) {}
  void unit(auto&&...) {}
  void colour(auto&&...) {}
  void file(auto&&...) {}
  void cells(auto&&...) {}
  void whole_list(auto&&...) {}
  void object(auto&&...) {}
  void optional_object(auto&&...) {}
  void list(auto&&...) {}
  void fabric(auto&&...) {}
  void tethers(auto&&...) {}
  void contacts(auto&&...) {}
};

// Reads one key, or writes it where a value is given.
struct Access : List {
  std::string_view wanted;
  const Variant* given = nullptr;
  Variant read = {};

  bool is(std::string_view key) const { return key == wanted; }
  void text(std::string_view key, std::string& value) {
    if (!is(key)) return;
    if (given) value = given->to_string();
    else read = Variant(value);
  }
  void flag(std::string_view key, bool& value) {
    if (!is(key)) return;
    if (given) value = given->to_bool();
    else read = Variant(value);
  }
  void optional_flag(std::string_view key, std::optional<bool>& value) {
    if (!is(key)) return;
    if (!given) read = Variant(value ? 1 + int(*value) : 0);
    else if (given->type() == kFlag) value = given->to_bool();   // a project of the time when it was one of two
    else if (const std::int64_t choice = given->to_int(); choice == 1 || choice == 2) value = choice == 2;
    else value.reset();
  }
  void number(std::string_view key, double& value, const Range& range) {
    if (!is(key)) return;
    if (given) value = within(given->to_double(), range);
    else read = Variant(value);
  }
  void optional_number(std::string_view key, std::optional<double>& value, const Range& range) {
    if (!is(key)) return;
    if (!given) read = Variant(value.value_or(0));
    else if (given->to_double() > 0) value = within(given->to_double(), range);
    else value.reset();
  }
  void stiffness(std::string_view key, double& value, const Range& range) {
    if (!is(key)) return;
    if (!given) read = Variant(value);
    else if (std::isinf(given->to_double()) && given->to_double() > 0) value = given->to_double();   // rigid
    else value = within(given->to_double(), range);
  }
  void whole(std::string_view key, std::uint32_t& value, const Range& range) {
    if (!is(key)) return;
    if (given) value = static_cast<std::uint32_t>(within(double(given->to_int()), range));
    else read = Variant(value);
  }
  template <class E>
  void choice(std::string_view key, E& value, Names names) {
    if (!is(key)) return;
    if (!given) read = Variant(int(value));
    else if (const std::int64_t k = given->to_int(); k >= 0 && k < std::int64_t(names.size())) value = static_cast<E>(k);
  }
  void vector3(std::string_view key, weft::Vec3& value, const Range& range) {
    if (!is(key)) return;
    if (!given) {
      read = Variant(value);
      return;
    }
    const weft::Vec3 v = given->to_vector3();
    value = {float(within(v.x, range)), float(within(v.y, range)), float(within(v.z, range))};
  }
};

}  // namespace

template <class T>
std::vector<Property> properties_of(const std::string& prefix, const std::string& object, std::function<T&(godot::Instance&)> at,
                                    std::vector<std::string> without) {
  List list;
  T looked_at{};
  weft::scene_fields::fields(list, looked_at);
  std::vector<Property> properties;
  for (Property& property : list.found) {
    const std::string key = property.name;
    if (std::ranges::find(without, key) != without.end()) continue;
    property.help = help_of(object, key);
    property.get = [at, key](const godot::Instance& instance) {
      Access access;
      access.wanted = key;
      weft::scene_fields::fields(access, at(const_cast<godot::Instance&>(instance)));
      return access.read;
    };
    property.set = [at, key](godot::Instance& instance, const Variant& value) {
      Access access;
      access.wanted = key;
      access.given = &value;
      weft::scene_fields::fields(access, at(instance));
    };
    property.name = prefix + key;
    properties.push_back(std::move(property));
  }
  return properties;
}

WEFT_GODOT_FIELDS(weft::Fabric);
WEFT_GODOT_FIELDS(weft::Maps);
WEFT_GODOT_FIELDS(weft::MotionConstraints);
WEFT_GODOT_FIELDS(weft::Inertia);
WEFT_GODOT_FIELDS(weft::Gas);
WEFT_GODOT_FIELDS(weft::Tear);
WEFT_GODOT_FIELDS(weft::SolverSettings);
WEFT_GODOT_FIELDS(weft::Contacts);
WEFT_GODOT_FIELDS(weft::Air);
WEFT_GODOT_FIELDS(weft::Air::Gust);
WEFT_GODOT_FIELDS(weft::Air::Field);

}  // namespace weft_godot
