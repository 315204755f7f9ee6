// Checks a scene that a program made: one visitor that walks the reader's tables (engine/scene/fields.h) over values instead of JSON, with
// the reader's limits, sentences and rules between keys.
#include <cmath>

#include "engine/finite.h"
#include "engine/scene/fields.h"
#include "engine/scene/limits.h"
#include "engine/scene/rules.h"

namespace weft {
namespace {

using scene_fields::Names;

// Unit vectors that a program computed are so up to rounding.
constexpr double kUnitTolerance = 1e-3;

class SceneCheck {
 public:
  SceneCheck(std::string path, Faults& faults) : path_(std::move(path)), faults_(faults) {}

  template <class T>
  static void object_at(const std::string& path, const T& value, Faults& faults) {
    T looked_at = value;   // the tables are for readers, too, which change what they walk
    const std::size_t before = faults.count();
    SceneCheck check(path, faults);
    scene_fields::fields(check, looked_at);
    // Rules between values take each of them to be within its own limits.
    if (faults.count() == before) weft::check(Read{nullptr, path, faults}, value);
  }

  void note(std::string_view) {}
  void text(std::string_view, const std::string&) {}
  void optional_texts(std::string_view key, const std::optional<std::vector<std::string>>& values, std::size_t most) {
    if (values) short_enough(key, values->size(), most);
  }
  void flag(std::string_view, bool) {}
  void optional_flag(std::string_view, const std::optional<bool>&) {}
  void number(std::string_view key, double value, const scene_fields::Range& range) { look(path_of(key), value, range); }
  void optional_number(std::string_view key, const std::optional<double>& value, const scene_fields::Range& range) {
    if (value) number(key, *value, range);
  }
  void stiffness(std::string_view key, double value, const scene_fields::Range& range) {
    if (!(std::isinf(value) && value > 0)) number(key, value, range);   // infinite is "rigid"
  }
  void whole(std::string_view key, std::uint32_t value, const scene_fields::Range& range) { look(path_of(key), double(value), range); }
  void whole_list(std::string_view key, const std::vector<std::uint32_t>& values, const scene_fields::Range& range, std::size_t most) {
    if (!short_enough(key, values.size(), most)) return;
    for (std::size_t k = 0; k < values.size(); ++k) look(entry(key, k), double(values[k]), range);
  }
  template <class E>
  void choice(std::string_view key, E value, Names names) {
    choose(path_of(key), value, names);
  }
  template <class E>
  void choices(std::string_view key, const std::vector<E>& values, Names names) {
    if (!short_enough(key, values.size(), names.size())) return;
    for (std::size_t k = 0; k < values.size(); ++k) choose(entry(key, k), values[k], names);
  }
  void vector2(std::string_view key, Vec2 v, const scene_fields::Range& range) {
    look(entry(key, 0), v.x, range), look(entry(key, 1), v.y, range);
  }
  void vector3(std::string_view key, Vec3 v, const scene_fields::Range& range) {
    look(entry(key, 0), v.x, range), look(entry(key, 1), v.y, range), look(entry(key, 2), v.z, range);
  }
  void colour(std::string_view key, Vec3 v, const scene_fields::Range& range) { vector3(key, v, range); }
  void direction(std::string_view key, Vec3 v) {
    const std::size_t before = faults_.count();
    vector3(key, v, scene_fields::kPlace);
    if (const double size = std::hypot(v.x, v.y, v.z); faults_.count() == before && size < scene_fields::kShortestDirection)
      faults_.add(path_of(key), scene_fields::no_direction(number_text(size)));
  }
  void unit(std::string_view key, Vec3 v) {
    const std::size_t before = faults_.count();
    direction(key, v);
    if (const double size = std::hypot(v.x, v.y, v.z); faults_.count() == before && std::abs(size - 1) > kUnitTolerance)
      faults_.add(path_of(key), "is a vector of length " + number_text(size) + ", not 1");
  }
  void cells(std::string_view key, std::uint32_t x, std::uint32_t y, const scene_fields::Range& range) {
    look(entry(key, 0), double(x), range), look(entry(key, 1), double(y), range);
  }
  void file(std::string_view, const std::string&, Names) {}   // who reads it says what is wrong with it
  template <class T>
  void object(std::string_view key, const T& value) {
    object_at(path_of(key), value, faults_);
  }
  template <class T>
  void optional_object(std::string_view key, const std::optional<T>& value) {
    if (value) object(key, *value);
  }
  template <class T>
  void list(std::string_view key, const std::vector<T>& values, std::size_t least, std::size_t most) {
    if (values.size() < least) faults_.add(path_of(key), "is empty: at least " + std::to_string(least) + " is needed");
    if (!short_enough(key, values.size(), most)) return;
    for (std::size_t k = 0; k < values.size(); ++k) object_at(entry(key, k), values[k], faults_);
  }
  void fabric(std::string_view key, const Fabric& value) { object(key, value); }
  void tethers(std::string_view key, const Cloth& cloth) {
    object(key, scene_fields::Tethers{cloth.tethers_per_vertex, cloth.tether_slack});
  }
  void contacts(std::string_view key, const Contacts& value) { object(key, value); }

 private:
  std::string path_of(std::string_view key) const { return (path_.empty() ? "" : path_ + '.') + std::string(key); }
  std::string entry(std::string_view key, std::size_t index) const { return path_of(key) + '[' + std::to_string(index) + ']'; }

  template <class T>
  void look(const std::string& path, T value, const scene_fields::Range& range) {
    if (const std::string what = outside(value, range); !what.empty()) faults_.add(path, what);
  }
  template <class E>
  void choose(const std::string& path, E value, Names names) {
    if (const auto number = static_cast<std::int64_t>(value); number < 0 || number >= std::int64_t(names.size()))
      faults_.add(path, std::to_string(number) + " is not the number of " + either(names));
  }
  bool short_enough(std::string_view key, std::size_t size, std::size_t most) {
    if (size > most) faults_.add(path_of(key), std::to_string(size) + " entries are more than " + std::to_string(most));
    return size <= most;
  }

  std::string path_;
  Faults& faults_;
};

}  // namespace

Result<void> check(const Scene& scene) try {
  Faults faults;
  SceneCheck::object_at("", scene, faults);
  if (!faults.empty()) return Error{faults.text()};
  return {};
} catch (...) {
  return caught("the scene");
}

}  // namespace weft
