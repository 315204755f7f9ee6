// JSON values to a Scene: one visitor that walks the tables in engine/scene/fields.h. Reading never stops at a fault; a value that
// is wrong keeps its default, so that everything after it is still looked at.
#include "engine/scene/reader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "compute/text.h"
#include "engine/scene/fields.h"
#include "engine/scene/json.h"
#include "engine/scene/limits.h"
#include "engine/scene/rules.h"

namespace weft {

namespace {

using nlohmann::json;
using scene_fields::Names;
using scene_fields::Range;

class Reader {
 public:
  Reader(const json& object, std::string path, const Nameable& nameable, Faults& faults)
      : object_(object), path_(std::move(path)), nameable_(nameable), faults_(faults) {}

  /// Reads one object whole: its table, then keys that are in no table, then the rules between keys.
  template <class T>
  static void read(const json& value, const std::string& path, const Nameable& nameable, Faults& faults, T& out) {
    if (!value.is_object()) return faults.add(path, shown(value) + ", not an object");
    Reader reader(value, path, nameable, faults);
    scene_fields::fields(reader, out);
    reader.refuse_unknown();
    check(Read{&value, path, faults}, out);
  }

  void note(std::string_view key) {
    if (const json* value = find(key); value && !value->is_string()) wrong(key, *value, "text");
  }

  void text(std::string_view key, std::string& out) {
    const json* value = find(key);
    if (!value) return;
    read_text(*value, path_of(key), out);
  }

  void optional_texts(std::string_view key, std::optional<std::vector<std::string>>& out, std::size_t most) {
    if (!object_.contains(key)) return known_.push_back(key);
    out.emplace();
    each(key, 0, most, [&](const json& entry, const std::string& path) {
      if (std::string text; read_text(entry, path, text)) out->push_back(std::move(text));
    });
  }

  void flag(std::string_view key, bool& out) {
    const json* value = find(key);
    if (!value) return;
    if (!value->is_boolean()) return wrong(key, *value, "true or false");
    out = value->get<bool>();
  }

  void optional_flag(std::string_view key, std::optional<bool>& out) {
    if (find(key) == nullptr) return;
    flag(key, out.emplace());
  }

  void number(std::string_view key, double& out, const Range& range) {
    if (const json* value = find(key)) read_number(*value, path_of(key), range, out);
  }

  void optional_number(std::string_view key, std::optional<double>& out, const Range& range) {
    double number = 0;
    if (const json* value = find(key); value && read_number(*value, path_of(key), range, number)) out = number;
  }

  void stiffness(std::string_view key, double& out, const Range& range) {
    const json* value = find(key);
    if (!value) return;
    if (is_text(*value, "rigid")) {
      out = std::numeric_limits<double>::infinity();
    } else if (value->is_number()) {
      read_number(*value, path_of(key), range, out);
    } else {
      wrong(key, *value, "a number or \"rigid\"");
    }
  }

  void whole(std::string_view key, std::uint32_t& out, const Range& range) {
    if (const json* value = find(key)) read_whole(*value, path_of(key), range, out);
  }

  void whole_list(std::string_view key, std::vector<std::uint32_t>& out, const Range& range, std::size_t most) {
    each(key, 0, most, [&](const json& entry, const std::string& path) {
      std::uint32_t number = 0;
      if (read_whole(entry, path, range, number)) out.push_back(number);
    });
  }

  template <class E>
  void choice(std::string_view key, E& out, Names names) {
    if (const json* value = find(key)) read_choice(*value, path_of(key), names, out);
  }

  template <class E>
  void choices(std::string_view key, std::vector<E>& out, Names names) {
    each(key, 0, names.size(), [&](const json& entry, const std::string& path) {
      E chosen{};
      if (read_choice(entry, path, names, chosen)) out.push_back(chosen);
    });
  }

  void vector2(std::string_view key, Vec2& out, const Range& range) {
    double v[2];
    if (const json* value = find(key); value && read_numbers(*value, path_of(key), range, v))
      out = {static_cast<float>(v[0]), static_cast<float>(v[1])};
  }

  void vector3(std::string_view key, Vec3& out, const Range& range) {
    double v[3];
    if (const json* value = find(key); value && read_numbers(*value, path_of(key), range, v))
      out = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  }

  void colour(std::string_view key, Vec3& out, const Range& range) { vector3(key, out, range); }
  void direction(std::string_view key, Vec3& out) { read_direction(key, out, false); }
  void unit(std::string_view key, Vec3& out) { read_direction(key, out, true); }

  void cells(std::string_view key, std::uint32_t& x, std::uint32_t& y, const Range& range) {
    const json* value = find(key);
    if (!value) return;
    if (!value->is_array() || value->size() != 2) return wrong(key, *value, "a list of 2 whole numbers");
    read_whole((*value)[0], path_of(key) + "[0]", range, x);
    read_whole((*value)[1], path_of(key) + "[1]", range, y);
  }

  void file(std::string_view key, std::string& out, Names endings) {
    const json* value = find(key);
    if (!value) return;
    if (!value->is_string()) return wrong(key, *value, "the name of a file");
    const std::string& name = value->get_ref<const std::string&>();
    if (name.empty()) return fault(key, "names no file");
    if (std::ranges::equal(endings, scene_fields::kMeshEndings) && std::ranges::find(nameable_.meshes, name) != nameable_.meshes.end()) {
      out = name;
      return;
    }
    if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20; }))
      return fault(key, shown(*value) + " has a control character in it");
    std::error_code error;
    const std::filesystem::path path = nameable_.folder / name;
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (std::find(endings.begin(), endings.end(), ending) == endings.end())
      return fault(key, shown(*value) + " does not end in " + either(endings));
    if (!std::filesystem::exists(path, error))
      return fault(key, shown(*value) + " is not there (looked for " + printable(path.string(), 300) + ")");
    if (!std::filesystem::is_regular_file(path, error)) return fault(key, shown(*value) + " is not a file");
    out = name;
  }

  template <class T>
  void object(std::string_view key, T& out) {
    if (const json* value = find(key)) read(*value, path_of(key), nameable_, faults_, out);
  }

  template <class T>
  void optional_object(std::string_view key, std::optional<T>& out) {
    if (const json* value = find(key)) read(*value, path_of(key), nameable_, faults_, out.emplace());
  }

  template <class T>
  void list(std::string_view key, std::vector<T>& out, std::size_t least, std::size_t most) {
    if (least > 0 && !object_.contains(key)) fault(key, "is missing: at least " + std::to_string(least) + " is needed");
    each(key, least, most, [&](const json& entry, const std::string& path) { read(entry, path, nameable_, faults_, out.emplace_back()); });
  }

  /// A preset's name, or an object that starts from a preset's figures.
  void fabric(std::string_view key, Fabric& out) {
    const json* value = find(key);
    if (!value) return;
    if (value->is_string()) return read_preset(*value, path_of(key), out);
    if (!value->is_object()) return wrong(key, *value, "a preset's name or an object");
    if (const auto preset = value->find("preset"); preset != value->end() && preset->is_string())
      read_preset(*preset, path_of(key) + ".preset", out);
    read(*value, path_of(key), nameable_, faults_, out);
  }

  /// true, false, or an object that says how many and how slack.
  void tethers(std::string_view key, Cloth& out) {
    const json* value = find(key);
    if (!value) return;
    if (value->is_boolean()) {
      out.tethers = value->get<bool>();
    } else if (value->is_object()) {
      scene_fields::Tethers tethers;
      read(*value, path_of(key), nameable_, faults_, tethers);
      out.tethers = true;
      out.tethers_per_vertex = tethers.per_vertex;
      out.tether_slack = tethers.slack;
    } else {
      wrong(key, *value, "true, false or an object");
    }
  }

  /// true, false, or an object, which means true unless it says otherwise.
  void contacts(std::string_view key, Contacts& out) {
    const json* value = find(key);
    if (!value) return;
    if (value->is_boolean()) {
      out.enabled = value->get<bool>();
    } else if (value->is_object()) {
      out.enabled = true;
      read(*value, path_of(key), nameable_, faults_, out);
    } else {
      wrong(key, *value, "true, false or an object");
    }
  }

 private:
  const json* find(std::string_view key) {
    known_.push_back(key);
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
  }

  std::string path_of(std::string_view key) const { return (path_.empty() ? "" : path_ + '.') + std::string(key); }
  void fault(std::string_view key, std::string_view what) { faults_.add(path_of(key), what); }
  void wrong(std::string_view key, const json& value, std::string_view wanted) { wrong_at(path_of(key), value, wanted); }

  void wrong_at(const std::string& path, const json& value, std::string_view wanted) {
    std::string text = shown(value);
    if (value.is_string()) text += " is text";
    faults_.add(path, text + ", not " + std::string(wanted));
  }

  bool read_text(const json& value, const std::string& path, std::string& out) {
    if (!value.is_string()) return wrong_at(path, value, "text"), false;
    const std::string& text = value.get_ref<const std::string&>();
    constexpr std::size_t kLongest = 1000;
    if (text.size() > kLongest)
      return faults_.add(path, "is " + std::to_string(text.size()) + " bytes long, more than " + std::to_string(kLongest)), false;
    out = text;
    return true;
  }

  bool read_number(const json& value, const std::string& path, const Range& range, double& out) {
    if (!value.is_number()) return wrong_at(path, value, "a number"), false;
    const double number = value.get<double>();
    if (const std::string what = outside(number, range); !what.empty()) return faults_.add(path, what), false;
    out = number;
    return true;
  }

  bool read_whole(const json& value, const std::string& path, const Range& range, std::uint32_t& out) {
    if (!value.is_number()) return wrong_at(path, value, "a whole number"), false;
    double number = value.get<double>();
    if (number != std::floor(number)) return wrong_at(path, value, "a whole number"), false;
    if (!read_number(value, path, range, number)) return false;
    out = static_cast<std::uint32_t>(number);
    return true;
  }

  template <std::size_t N>
  bool read_numbers(const json& value, const std::string& path, const Range& range, double (&out)[N]) {
    if (!value.is_array() || value.size() != N) return wrong_at(path, value, "a list of " + std::to_string(N) + " numbers"), false;
    bool good = true;
    for (std::size_t i = 0; i < N; ++i) {
      good &= read_number(value[i], path + '[' + std::to_string(i) + ']', range, out[i]);
      // A number may be above 0 and still nothing once it is a float.
      if (good && range.above && static_cast<float>(out[i]) <= range.low) {
        faults_.add(path + '[' + std::to_string(i) + ']', number_text(out[i]) + " is too small to tell from " + number_text(range.low));
        good = false;
      }
    }
    return good;
  }

  void read_direction(std::string_view key, Vec3& out, bool normalise) {
    const json* value = find(key);
    double v[3];
    if (!value || !read_numbers(*value, path_of(key), scene_fields::kPlace, v)) return;
    const double size = std::hypot(v[0], v[1], v[2]);
    if (size < scene_fields::kShortestDirection) return fault(key, scene_fields::no_direction(number_text(size)));
    const double scale = normalise ? 1 / size : 1;
    out = {static_cast<float>(v[0] * scale), static_cast<float>(v[1] * scale), static_cast<float>(v[2] * scale)};
  }

  template <class E>
  bool read_choice(const json& value, const std::string& path, Names names, E& out) {
    if (!value.is_string()) return wrong_at(path, value, either(names)), false;
    const std::string& text = value.get_ref<const std::string&>();
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end()) return faults_.add(path, shown(value) + " is not " + either(names) + suggestion(text, names)), false;
    out = static_cast<E>(found - names.begin());
    return true;
  }

  void read_preset(const json& value, const std::string& path, Fabric& out) {
    static constexpr std::string_view kNames[] = {"silk", "cotton", "denim", "leather"};
    const std::string& name = value.get_ref<const std::string&>();
    if (const auto preset = fabric_preset(name))
      out = *preset;
    else
      faults_.add(path, shown(value) + " is not a fabric: " + either(kNames) + suggestion(name, kNames));
  }

  template <class F>
  void each(std::string_view key, std::size_t least, std::size_t most, F&& read_entry) {
    const json* value = find(key);
    if (!value) return;
    if (!value->is_array()) return wrong(key, *value, "a list");
    if (value->size() < least) fault(key, "is empty: at least " + std::to_string(least) + " is needed");
    if (value->size() > most) return fault(key, std::to_string(value->size()) + " entries are more than " + std::to_string(most));
    for (std::size_t i = 0; i < value->size(); ++i) read_entry((*value)[i], path_of(key) + '[' + std::to_string(i) + ']');
  }

  void refuse_unknown() {
    for (const auto& [key, value] : object_.items())
      if (std::find(known_.begin(), known_.end(), key) == known_.end())
        faults_.add(path_of(printable(key)), "there is no such key" + suggestion(key, known_));
  }

  const json& object_;
  std::string path_;
  const Nameable& nameable_;
  Faults& faults_;
  std::vector<std::string_view> known_;
};

}  // namespace

void read_scene(const json& value, const Nameable& nameable, Scene& scene, Faults& faults) {
  scene.folder = nameable.folder;
  Reader::read(value, "", nameable, faults, scene);
}

}  // namespace weft
