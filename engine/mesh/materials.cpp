#include "engine/mesh/materials.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "engine/mesh/outline.h"

namespace weft::parts {
namespace {

using json = nlohmann::json;

void raise(json& object, const char* key, std::size_t by) {
  if (object.is_object() && object.contains(key) && object[key].is_number_unsigned()) object[key] = object[key].get<std::size_t>() + by;
}

std::size_t size_of(const JsonTree& lists, const char* key) { return lists.root.contains(key) ? lists.root[key].size() : 0; }

}  // namespace

std::vector<std::pair<std::uint32_t, std::vector<Triangle>>> by_material(const RenderMesh& mesh) {
  std::map<std::uint32_t, std::vector<Triangle>> groups;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    groups[mesh.material_of.empty() ? kNone : mesh.material_of[t]].push_back(mesh.triangles[t]);
  return {std::make_move_iterator(groups.begin()), std::make_move_iterator(groups.end())};
}

JsonTree material_lists(const Materials& materials, std::size_t textures, std::size_t samplers, std::size_t images) {
  JsonTree lists(json::object());
  if (outline_fault(materials.text).empty()) lists = parsed_json(materials.text);
  for (const char* key : {"materials", "textures", "samplers", "images"}) {
    if (lists.root.is_object() && lists.root.contains(key) && lists.root[key].is_array()) continue;
    if (!lists.root.is_object()) lists = JsonTree(json::object());   // a host's own, which is no JSON
    put(lists, key, json::array());
  }
  for_textures(lists.root["materials"], [&](const std::string&, json& info) { raise(info, "index", textures); });
  for (json& texture : lists.root["textures"]) {
    raise(texture, "sampler", samplers);
    raise(texture, "source", images);
    if (texture.is_object() && texture.contains("extensions"))
      for (json& extension : texture["extensions"]) raise(extension, "source", images);
  }
  for (json& image : lists.root["images"]) raise(image, "bufferView", images);
  return lists;
}

void add_extensions(const json& value, std::vector<std::string>& names) {
  if (!value.is_structured()) return;
  if (value.is_object() && value.contains("extensions") && value["extensions"].is_object())
    for (const auto& [name, content] : value["extensions"].items())
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  for (const json& entry : value) add_extensions(entry, names);
}

std::uint32_t append(Materials& all, const Materials& added) {
  const auto first = static_cast<std::uint32_t>(all.count);
  JsonTree lists = material_lists(all);
  JsonTree more = material_lists(added, size_of(lists, "textures"), size_of(lists, "samplers"), all.images.size());
  for (const char* key : {"materials", "textures", "samplers", "images"})
    for (json& entry : more.root[key]) lists.root[key].push_back(std::move(entry));
  all.count += added.count;
  all.text = lists.root.dump();
  all.images.insert(all.images.end(), added.images.begin(), added.images.end());
  return first;
}

}  // namespace weft::parts
