#include "engine/mesh/glb.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <span>
#include <utility>

#include "engine/mesh/materials.h"

namespace weft::glb {
namespace {

using json = nlohmann::json;

template <class T>
std::size_t add(Scene& scene, std::span<const T> values, int component, const char* type, std::size_t count, int target) {
  JsonTree view = object_of("buffer", 0, "byteOffset", scene.binary.size(), "byteLength", values.size_bytes(), "target", target);
  JsonTree accessor = object_of("bufferView", scene.views.root.size(), "componentType", component, "count", count, "type", type);
  scene.views.root.push_back(std::move(view.root));
  scene.accessors.root.push_back(std::move(accessor.root));
  scene.binary.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  return scene.accessors.root.size() - 1;
}

std::string words(std::initializer_list<std::uint64_t> values) {
  std::string bytes;
  for (const std::uint64_t value : values) {
    const auto word = static_cast<std::uint32_t>(value);
    bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
  }
  return bytes;
}

// Those of a mesh, after its arrays; and one that is double-sided where some triangles have none.
void add_materials(Scene& scene, const RenderMesh& mesh, bool some_have_none) {
  if (mesh.materials) {
    JsonTree lists = parts::material_lists(*mesh.materials);
    for (json& image : lists.root["images"])
      if (image.is_object() && image.contains("bufferView") && image["bufferView"].is_number_unsigned())
        image["bufferView"] = image["bufferView"].get<std::size_t>() + scene.views.root.size();
    for (const std::string& image : mesh.materials->images) {
      JsonTree view = object_of("buffer", 0, "byteOffset", scene.binary.size(), "byteLength", image.size());
      scene.views.root.push_back(std::move(view.root));
      scene.binary += image;
      scene.binary.resize((scene.binary.size() + 3) / 4 * 4, '\0');
    }
    for (const char* key : {"materials", "textures", "samplers", "images"})   // an empty list is not allowed
      if (!lists.root[key].empty()) put(scene.materials, key, std::move(lists.root[key]));
    std::vector<std::string> names;
    parts::add_extensions(scene.materials.root, names);
    if (!names.empty()) put(scene.materials, "extensionsUsed", names);
  }
  if (!some_have_none) return;
  JsonTree look = object_of("metallicFactor", 0, "roughnessFactor", 0.8);
  JsonTree plain = object_of("doubleSided", true, "pbrMetallicRoughness", std::move(look));
  if (!scene.materials.root.contains("materials")) put(scene.materials, "materials", json::array());
  scene.materials.root["materials"].push_back(std::move(plain.root));
}

}  // namespace

Result<Scene> scene_of(const std::filesystem::path& file, const RenderMesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  if (mesh.triangles.empty() || vertices == 0)
    return fail(file.string(), " is not written: a mesh of ", vertices, " vertices and ", mesh.triangles.size(),
                " triangles has nothing to draw");
  if (Result<void> checked = parts::check_length(file, "normals", mesh.normals.size(), vertices); !checked) return checked.take_error();
  if (Result<void> checked = parts::check_length(file, "texture coordinates", mesh.uvs.size(), vertices); !checked)
    return checked.take_error();
  if (Result<void> checked = parts::check_indices(file, mesh.triangles, vertices); !checked) return checked.take_error();

  Scene scene;
  JsonTree shown = json::object();
  json& attributes = shown.root;
  attributes["POSITION"] = add(scene, std::span<const Vec3>(mesh.positions), kFloat, "VEC3", vertices, kVertexTarget);
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  for (const auto& [key, bound] : {std::pair{"min", low}, std::pair{"max", high}}) {
    json& place = scene.accessors.root.back()[key];
    place = {bound.x, bound.y, bound.z};
  }
  if (!mesh.normals.empty())
    attributes["NORMAL"] = add(scene, std::span<const Vec3>(mesh.normals), kFloat, "VEC3", vertices, kVertexTarget);
  if (!mesh.uvs.empty()) attributes["TEXCOORD_0"] = add(scene, std::span<const Vec2>(mesh.uvs), kFloat, "VEC2", vertices, kVertexTarget);
  const std::size_t materials = mesh.materials ? mesh.materials->count : 0;
  if (!mesh.material_of.empty() && mesh.material_of.size() != mesh.triangles.size())
    return fail(file.string(), " is not written: ", mesh.material_of.size(), " materials for ", mesh.triangles.size(), " triangles");
  bool some_have_none = false;
  for (const auto& [material, triangles] : parts::by_material(mesh)) {
    if (material != kNone && material >= materials)
      return fail(file.string(), " is not written: a triangle has material ", material, " of ", materials);
    some_have_none |= material == kNone;
    const std::size_t indices =
        add(scene, std::span<const Triangle>(triangles), kInteger, "SCALAR", triangles.size() * 3, kIndexTarget);
    JsonTree flat(json(shown.root));   // numbers alone
    JsonTree primitive = object_of("attributes", std::move(flat), "indices", indices, "material", material == kNone ? materials : material);
    scene.primitives.root.push_back(std::move(primitive.root));
  }
  add_materials(scene, mesh, some_have_none);
  return scene;
}

JsonTree document_of(Scene& scene, std::uint64_t bytes, std::string_view name) {
  JsonTree node = object_of("mesh", 0);
  if (!name.empty()) put(node, "name", std::string(name));
  JsonTree document = object_of("asset", object_of("version", "2.0", "generator", "Weft"), "scene", 0, "scenes",
                                list_of(object_of("nodes", list_of(json(0)))), "nodes", list_of(std::move(node)), "meshes",
                                list_of(object_of("primitives", std::move(scene.primitives))), "bufferViews", std::move(scene.views),
                                "buffers", list_of(object_of("byteLength", bytes)));
  for (auto& [key, list] : scene.materials.root.items()) put(document, key, std::move(list));
  return document;
}

std::string head_of(std::uint64_t text_bytes, std::uint64_t binary_bytes) {
  return "glTF" + words({2, kHeadBytes + text_bytes + kBinaryHeadBytes + binary_bytes, text_bytes}) + "JSON";
}

std::string binary_head_of(std::uint64_t binary_bytes) { return words({binary_bytes}) + std::string("BIN\0", 4); }

}  // namespace weft::glb
