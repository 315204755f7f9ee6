#include "engine/shading/looks.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/mesh/materials.h"

namespace weft::shading {
namespace {

using json = nlohmann::json;

// A member; null where it is not there. A host's own text may hold anything anywhere.
const json& at(const json& value, const char* key) {
  static const json kNothing;
  const auto found = value.is_object() ? value.find(key) : value.end();
  return value.is_object() && found != value.end() ? *found : kNothing;
}

const json& entry(const json& list, const json& number) {
  static const json kNothing;
  return list.is_array() && number.is_number_unsigned() && number.get<std::uint64_t>() < list.size() ? list[number.get<std::size_t>()]
                                                                                                     : kNothing;
}

double number(const json& value, double otherwise, double low, double high) {
  const double read = value.is_number() ? value.get<double>() : otherwise;
  return std::isfinite(read) ? std::clamp(read, low, high) : otherwise;
}

// What a material has that pictures do not show.
class Left {
 public:
  Left(std::string of, std::vector<std::string>& notes) : of_(std::move(of)), notes_(notes) {}
  void out(const std::string& what) {
    if (said_.insert(what).second) notes_.push_back(of_ + what);
  }

 private:
  std::string of_;
  std::vector<std::string>& notes_;
  std::set<std::string> said_;
};

const std::string* image_of(const json& lists, const json& info, const Materials& materials) {
  const json& texture = entry(lists["textures"], at(info, "index"));
  const json& image = entry(lists["images"], at(texture, "source"));
  const json& number = at(image, "bufferView");
  if (!number.is_number_unsigned() || number.get<std::uint64_t>() >= materials.images.size()) return nullptr;
  return &materials.images[number.get<std::size_t>()];
}

void see_alpha(const json& material, Look& look, Left& left) {
  const json& mode = at(material, "alphaMode");
  if (is_text(mode, "MASK")) look.cutoff = number(at(material, "alphaCutoff"), 0.5, 0, 1);
  if (is_text(mode, "BLEND")) {
    look.cutoff = 0.5;
    left.out("is transparent: drawn is what has an alpha of a half or more, opaque");
  }
}

}  // namespace

Look look_of(std::string name, const Appearance& appearance, const std::filesystem::path& folder) {
  const auto source = [&](Map map, const std::string& file) { return Source{map, file.empty() ? std::filesystem::path() : folder / file}; };
  return {.name = std::move(name),
          .maps = {source(Map::albedo, appearance.albedo), source(Map::normal, appearance.normal),
                   source(Map::roughness, appearance.roughness), source(Map::occlusion, appearance.occlusion)},
          .base_colour = appearance.base_colour,
          .roughness = appearance.roughness_factor,
          .metallic = appearance.metallic,
          .repeat = appearance.repeat};
}

std::vector<std::pair<std::uint32_t, std::vector<Triangle>>> runs_of(const RenderMesh& mesh, const Appearance* appearance) {
  if (appearance != nullptr && appearance->mesh_materials && mesh.materials) return parts::by_material(mesh);
  return {{kNone, mesh.triangles}};
}

std::vector<Look> looks_of(const std::string& name, const Materials& materials, std::vector<std::string>& notes) {
  const JsonTree lists = parts::material_lists(materials);
  std::vector<Look> looks;
  for (std::size_t m = 0; m < materials.count; ++m) {
    const json& material = entry(lists.root["materials"], m), &surface = at(material, "pbrMetallicRoughness");
    Look look;
    look.name = name + ", material " + std::to_string(m);
    Left left(look.name + ": ", notes);
    const json& colour = at(surface, "baseColorFactor");
    const auto channel = [&](std::size_t c) { return static_cast<float>(number(entry(colour, c), 1, 0, 1)); };
    look.base_colour = {channel(0), channel(1), channel(2)};
    look.roughness = number(at(surface, "roughnessFactor"), 1, 0, 1);
    look.metallic = number(at(surface, "metallicFactor"), 1, 0, 1);
    const json& normal = at(material, "normalTexture"), &occlusion = at(material, "occlusionTexture");
    const struct {
      Map map;
      const json& info;
      double strength;
    } maps[] = {{Map::albedo, at(surface, "baseColorTexture"), 1},
                {Map::normal, normal, number(at(normal, "scale"), 1, -100, 100)},
                {Map::surface, at(surface, "metallicRoughnessTexture"), 1},
                {Map::occlusion, occlusion, number(at(occlusion, "strength"), 1, 0, 1)}};
    for (std::size_t k = 0; k < look.maps.size(); ++k) {
      look.maps[k] = {maps[k].map, {}, image_of(lists.root, maps[k].info, materials), maps[k].strength};
      if (maps[k].info.is_object() && look.maps[k].embedded == nullptr) left.out("a texture without a PNG or JPEG is left out");
    }
    see_alpha(material, look, left);
    const json& emission = at(material, "emissiveFactor");
    for (std::size_t c = 0; c < 3; ++c)
      if (number(entry(emission, c), 0, 0, 1) > 0) left.out("the light that it gives off is left out");
    looks.push_back(std::move(look));
  }
  return looks;
}

}  // namespace weft::shading
