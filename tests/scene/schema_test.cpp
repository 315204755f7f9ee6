// The schema and the loader say the same: a visitor turns the loader's own tables into schema properties, and these are
// compared with assets/scene.schema.json key by key, with every default and every limit.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/scene/fields.h"

#ifndef WEFT_ASSETS
#define WEFT_ASSETS "assets"
#endif

namespace {

using nlohmann::json;
using weft::scene_fields::Names;
using weft::scene_fields::Range;

json limits(const Range& range) {
  return {{range.above ? "exclusiveMinimum" : "minimum", range.low}, {range.below ? "exclusiveMaximum" : "maximum", range.high}};
}

json number_of(const Range& range, const char* type = "number") {
  json number = limits(range);
  number["type"] = type;
  return number;
}

json names_of(Names names) { return {{"type", "string"}, {"enum", std::vector<std::string>(names.begin(), names.end())}}; }

json vector_of(std::size_t count, const json& items) {
  return {{"type", "array"}, {"minItems", count}, {"maxItems", count}, {"items", items}};
}

// A float's shortest decimal, so that 0.96f is 0.96.
double plain(float value) {
  std::ostringstream text;
  text << value;
  return std::stod(text.str());
}

json array_of(std::size_t least, std::size_t most, const json& items) {
  return {{"type", "array"}, {"minItems", least}, {"maxItems", most}, {"default", json::array()}, {"items", items}};
}

// Collects one object's properties; objects inside are collected under "properties" of their own.
struct Lister {
  json properties = json::object();

  template <class T>
  static json properties_of(T value) {
    Lister lister;
    weft::scene_fields::fields(lister, value);
    return {{"type", "object"}, {"properties", lister.properties}};
  }

  void put(std::string_view key, json property) {
    ASSERT_FALSE(properties.contains(key)) << key << " stands twice in a table";
    properties[std::string(key)] = std::move(property);
  }
  json with_default(json property, json value) {
    property["default"] = std::move(value);
    return property;
  }

  void note(std::string_view key) { put(key, {{"type", "string"}}); }
  void text(std::string_view key, std::string& value) {
    // The one text with a closed set of values is the preset.
    if (key == "preset")
      put(key, {{"type", "string"}, {"enum", {"silk", "cotton", "denim", "leather"}}, {"default", value}});
    else
      put(key, {{"type", "string"}, {"maxLength", 1000}, {"default", value}});
  }
  void optional_texts(std::string_view key, std::optional<std::vector<std::string>>&, std::size_t most) {
    put(key, {{"type", "array"}, {"maxItems", most}, {"items", {{"type", "string"}, {"maxLength", 1000}}}});
  }
  void optional_flag(std::string_view key, std::optional<bool>&) { put(key, {{"type", "boolean"}}); }
  void flag(std::string_view key, bool& value) { put(key, {{"type", "boolean"}, {"default", value}}); }
  void number(std::string_view key, double& value, const Range& range) { put(key, with_default(number_of(range), value)); }
  void optional_number(std::string_view key, std::optional<double>&, const Range& range) { put(key, number_of(range)); }
  void stiffness(std::string_view key, double& value, const Range& range) {
    put(key, {{"oneOf", {number_of(range), {{"const", "rigid"}}}}, {"default", value}});
  }
  void whole(std::string_view key, std::uint32_t& value, const Range& range) { put(key, with_default(number_of(range, "integer"), value)); }
  void whole_list(std::string_view key, std::vector<std::uint32_t>&, const Range& range, std::size_t most) {
    put(key, array_of(0, most, number_of(range, "integer")));
  }
  template <class E>
  void choice(std::string_view key, E& value, Names names) {
    put(key, with_default(names_of(names), names[static_cast<std::size_t>(value)]));
  }
  template <class E>
  void choices(std::string_view key, std::vector<E>&, Names names) {
    put(key, array_of(0, names.size(), names_of(names)));
  }
  void vector2(std::string_view key, weft::Vec2& v, const Range& range) {
    put(key, with_default(vector_of(2, number_of(range)), {plain(v.x), plain(v.y)}));
  }
  void vector3(std::string_view key, weft::Vec3& v, const Range& range) {
    put(key, with_default(vector_of(3, number_of(range)), {plain(v.x), plain(v.y), plain(v.z)}));
  }
  void colour(std::string_view key, weft::Vec3& v, const Range& range) { vector3(key, v, range); }
  void direction(std::string_view key, weft::Vec3& v) { vector3(key, v, weft::scene_fields::kPlace); }
  void unit(std::string_view key, weft::Vec3& v) {
    EXPECT_NEAR(length(v), 1, 1e-6) << key;
    vector3(key, v, weft::scene_fields::kPlace);
  }
  void cells(std::string_view key, std::uint32_t& x, std::uint32_t& y, const Range& range) {
    put(key, with_default(vector_of(2, number_of(range, "integer")), {x, y}));
  }
  void file(std::string_view key, std::string& value, Names) { put(key, {{"type", "string"}, {"minLength", 1}, {"default", value}}); }
  template <class T>
  void object(std::string_view key, T&) {
    put(key, properties_of(T{}));
  }
  template <class T>
  void optional_object(std::string_view key, std::optional<T>&) {
    put(key, properties_of(T{}));
  }
  template <class T>
  void list(std::string_view key, std::vector<T>&, std::size_t least, std::size_t most) {
    put(key, array_of(least, most, properties_of(T{})));
  }
  void fabric(std::string_view key, weft::Fabric& value) {
    put(key, {{"oneOf", {{{"type", "string"}, {"enum", {"silk", "cotton", "denim", "leather"}}}, properties_of(weft::Fabric{})}},
              {"default", value.preset}});
  }
  void tethers(std::string_view key, weft::Cloth& value) {
    put(key, {{"oneOf", {{{"type", "boolean"}}, properties_of(weft::scene_fields::Tethers{})}}, {"default", value.tethers}});
  }
  void contacts(std::string_view key, weft::Contacts& value) {
    put(key, {{"oneOf", {{{"type", "boolean"}}, properties_of(value)}}});
  }
};

json load_schema() {
  std::ifstream file(WEFT_ASSETS "/scene.schema.json");
  return json::parse(file, nullptr, false);
}

// References followed, and what a table does not know (descriptions, which keys are required, patterns) left away.
json resolved(const json& schema, json node, const std::string& path) {
  if (node.is_array()) {
    for (std::size_t i = 0; i < node.size(); ++i) node[i] = resolved(schema, node[i], path);
    return node;
  }
  if (!node.is_object()) return node;
  if (node.contains("$ref")) {
    json target = schema["$defs"][node["$ref"].get<std::string>().substr(std::string("#/$defs/").size())];
    EXPECT_TRUE(target.is_object()) << path << ": " << node["$ref"] << " leads nowhere";
    node.erase("$ref");
    target.update(node);
    return resolved(schema, target, path);
  }
  if (node.contains("properties")) {
    EXPECT_EQ(node.value("additionalProperties", true), false) << path << " lets unknown keys pass";
    json properties = json::object();
    for (const auto& [key, value] : node["properties"].items()) {
      EXPECT_TRUE(value.contains("description")) << path << '.' << key << " has no description";
      properties[key] = resolved(schema, value, path + '.' + key);
    }
    return {{"type", "object"}, {"properties", properties}};
  }
  for (const char* unknown_to_tables : {"description", "pattern"}) node.erase(unknown_to_tables);
  for (const char* nested : {"items", "oneOf"})
    if (node.contains(nested)) node[nested] = resolved(schema, node[nested], path);
  return node;
}

// Differences as JSON patch lines: short, and each with its path.
std::string differences(const json& from, const json& to) {
  std::string all;
  for (const json& step : json::diff(from, to)) all += step.dump() + '\n';
  return all;
}

}  // namespace

TEST(SceneSchema, it_has_every_key_default_and_limit_of_the_loader_and_no_other) {
  const json schema = load_schema();
  ASSERT_TRUE(schema.is_object()) << "assets/scene.schema.json cannot be read";
  const json written = resolved(schema, schema, "scene");
  const json read = Lister::properties_of(weft::Scene{});
  EXPECT_EQ(differences(written, read), "");
}

TEST(SceneSchema, it_is_of_the_draft_that_it_names) {
  const json schema = load_schema();
  EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
  EXPECT_EQ(schema["required"], json::array({"cloths"}));
}
