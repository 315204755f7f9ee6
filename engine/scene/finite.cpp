// Checks a scene that a program made: walks the reader's tables for numbers that are not finite, or too large for shaders. The
// reader itself lets none through.
#include <cmath>

#include "compute/text.h"
#include "engine/finite.h"
#include "engine/scene/fields.h"

namespace weft {
namespace {

// A visitor with the members that engine/scene/fields.h lists; remembers the first fault with its JSON path.
struct FiniteCheck {
  using Names = scene_fields::Names;
  using Range = scene_fields::Range;

  std::string path, fault;

  void look(const std::string& key, double value) {
    if (fault.empty() && !std::isfinite(value))
      fault = path + key + ": " + (std::isnan(value) ? "not a number" : "infinite") + ", not finite";
  }
  template <class T>
  void inside(const std::string& key, T value) {
    FiniteCheck check{path + key + '.', {}};
    scene_fields::fields(check, value);
    if (fault.empty()) fault = check.fault;
  }

  void note(std::string_view) {}
  void text(std::string_view, const std::string&) {}
  void flag(std::string_view, bool) {}
  void number(std::string_view key, double value, const Range&) { look(std::string(key), value); }
  void optional_number(std::string_view key, const std::optional<double>& value, const Range&) {
    look(std::string(key), value.value_or(0));
  }
  void stiffness(std::string_view key, double value, const Range&) {
    look(std::string(key), value > 0 && std::isinf(value) ? 0 : value);   // infinite is "rigid"
  }
  void whole(std::string_view, std::uint32_t, const Range&) {}
  void whole_list(std::string_view, const std::vector<std::uint32_t>&, const Range&, std::size_t) {}
  template <class E>
  void choice(std::string_view, E, Names) {}
  template <class E>
  void choices(std::string_view, const std::vector<E>&, Names) {}
  void look(std::string_view key, Vec3 v) {
    look(std::string(key), double(v.x) + v.y + v.z);
    if (!fault.empty() || is_finite(v)) return;
    TextStream text;
    text << path << key << ": [" << v.x << ", " << v.y << ", " << v.z << "] is not shorter than " << kTooLarge
         << ", which floats cannot square";
    fault = text.str();
  }
  void vector2(std::string_view key, Vec2 v, const Range&) { look(key, Vec3{v.x, v.y, 0}); }
  void vector3(std::string_view key, Vec3 v, const Range&) { look(key, v); }
  void colour(std::string_view key, Vec3 v, const Range& range) { vector3(key, v, range); }
  void direction(std::string_view key, Vec3 v) { look(key, v); }
  void unit(std::string_view key, Vec3 v) { direction(key, v); }
  void cells(std::string_view, std::uint32_t, std::uint32_t, const Range&) {}
  void file(std::string_view, const std::string&, Names) {}
  template <class T>
  void object(std::string_view key, const T& value) {
    inside(std::string(key), value);
  }
  template <class T>
  void optional_object(std::string_view key, const std::optional<T>& value) {
    if (value) inside(std::string(key), *value);
  }
  template <class T>
  void list(std::string_view key, const std::vector<T>& values, std::size_t, std::size_t) {
    std::string name(key);
    for (std::size_t k = 0; k < values.size(); ++k) inside(name + '[' + std::to_string(k) + ']', values[k]);
  }
  void fabric(std::string_view key, const Fabric& value) { inside(std::string(key), value); }
  void tethers(std::string_view key, const Cloth& value) { look(std::string(key) + ".slack", value.tether_slack); }
  void contacts(std::string_view key, const Contacts& value) { inside(std::string(key), value); }
};

}  // namespace

std::string non_finite_fault(const Scene& scene) {
  Scene looked_at = scene;
  FiniteCheck check;
  scene_fields::fields(check, looked_at);
  return check.fault;
}

}  // namespace weft
