// A Scene back to JSON values: the reader's tables walked the other way. Internal.
#pragma once

#include <cmath>
#include <type_traits>

#include "engine/scene/fields.h"
#include "engine/scene/json.h"

namespace weft {

/// A visitor with the members that engine/scene/fields.h lists. Limits are the reader's business.
struct SceneWriter {
  using json = nlohmann::json;
  using Names = scene_fields::Names;
  using Range = scene_fields::Range;

  JsonTree members = json::object();

  template <class T>
  static JsonTree written(T value) {
    SceneWriter writer;
    if constexpr (std::is_same_v<T, Scene>) value.contacts.enabled = contacts_on(value);
    scene_fields::fields(writer, value);
    if constexpr (std::is_same_v<T, Collider>)
      for (const scene_fields::ShapeKey& own : scene_fields::kShapeKeys)
        if (!own.of[static_cast<std::size_t>(value.shape)]) writer.members.root.erase(std::string(own.key));
    return std::move(writer.members);
  }

  static json numbers_of(Vec2 v) { return {v.x, v.y}; }
  static json numbers_of(Vec3 v) { return {v.x, v.y, v.z}; }
  template <class V>
  void put(std::string_view key, V&& value) {
    weft::put(members, std::string(key), std::forward<V>(value));
  }

  void note(std::string_view) {}
  void text(std::string_view key, const std::string& value) { put(key, value); }
  void optional_texts(std::string_view key, const std::optional<std::vector<std::string>>& value, std::size_t) {
    if (value) put(key, *value);
  }
  void flag(std::string_view key, bool value) { put(key, value); }
  void optional_flag(std::string_view key, const std::optional<bool>& value) {
    if (value) put(key, *value);
  }
  void number(std::string_view key, double value, const Range&) { put(key, value); }
  void optional_number(std::string_view key, const std::optional<double>& value, const Range&) {
    if (value) put(key, *value);
  }
  void stiffness(std::string_view key, double value, const Range&) {
    if (std::isinf(value))
      put(key, "rigid");
    else
      put(key, value);
  }
  void whole(std::string_view key, std::uint32_t value, const Range&) { put(key, value); }
  void whole_list(std::string_view key, const std::vector<std::uint32_t>& value, const Range&, std::size_t) { put(key, value); }
  template <class E>
  void choice(std::string_view key, E value, Names names) {
    put(key, names[static_cast<std::size_t>(value)]);
  }
  template <class E>
  void choices(std::string_view key, const std::vector<E>& value, Names names) {
    json list = json::array();
    for (const E chosen : value) list.push_back(names[static_cast<std::size_t>(chosen)]);
    put(key, std::move(list));
  }
  void vector2(std::string_view key, Vec2 value, const Range&) { put(key, numbers_of(value)); }
  void vector3(std::string_view key, Vec3 value, const Range&) { put(key, numbers_of(value)); }
  void colour(std::string_view key, Vec3 value, const Range&) { put(key, numbers_of(value)); }
  void direction(std::string_view key, Vec3 value) { put(key, numbers_of(value)); }
  void unit(std::string_view key, Vec3 value) { put(key, numbers_of(value)); }
  void cells(std::string_view key, std::uint32_t x, std::uint32_t y, const Range&) { put(key, json{x, y}); }
  void file(std::string_view key, const std::string& value, Names) {
    if (!value.empty()) put(key, value);
  }
  template <class T>
  void object(std::string_view key, const T& value) {
    put(key, written(value));
  }
  template <class T>
  void optional_object(std::string_view key, const std::optional<T>& value) {
    if (value) put(key, written(*value));
  }
  template <class T>
  void list(std::string_view key, const std::vector<T>& value, std::size_t, std::size_t) {
    JsonTree list = json::array();
    for (const T& entry : value) {
      JsonTree one = written(entry);
      list.root.push_back(std::move(one.root));
    }
    put(key, std::move(list));
  }
  void fabric(std::string_view key, const Fabric& value) { put(key, written(value)); }
  void tethers(std::string_view key, const Cloth& value) {
    if (value.tethers)
      put(key, written(scene_fields::Tethers{value.tethers_per_vertex, value.tether_slack}));
    else
      put(key, false);
  }
  void contacts(std::string_view key, const Contacts& value) { put(key, written(value)); }
};

}  // namespace weft
