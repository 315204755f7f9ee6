// PLY and GLB, written by hand: both are a text header and raw little-endian arrays.
#include "engine/export.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <string>

#include "compute/file.h"
#include "engine/json_tree.h"

namespace weft {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");
static_assert(sizeof(Vec3) == 12 && sizeof(Vec2) == 8 && sizeof(Triangle) == 12);

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
void put_all(std::string& bytes, std::span<const T> values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

Result<void> check_length(const std::filesystem::path& file, const char* name, std::size_t count, std::size_t vertices) {
  if (count == 0 || count == vertices) return {};
  return fail(file.string(), " is not written: ", count, " ", name, " for ", vertices, " vertices; as many or none are needed");
}

Result<void> check_indices(const std::filesystem::path& file, std::span<const Triangle> triangles, std::size_t vertices) {
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t v : triangles[t])
      if (v >= vertices) return fail(file.string(), " is not written: triangle ", t, " has vertex ", v, " of ", vertices);
  return {};
}

}   // namespace

Result<void> write_ply(const std::filesystem::path& file, std::span<const Vec3> positions, std::span<const Vec3> normals,
                       std::span<const float> strain, std::span<const Triangle> triangles) try {
  if (Result<void> checked = check_length(file, "normals", normals.size(), positions.size()); !checked) return checked;
  if (Result<void> checked = check_length(file, "strains", strain.size(), positions.size()); !checked) return checked;
  if (Result<void> checked = check_indices(file, triangles, positions.size()); !checked) return checked;

  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment strain is a fraction of the rest length\nelement vertex " +
                      std::to_string(positions.size()) + "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!normals.empty()) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!strain.empty()) bytes += "property float strain\n";
  bytes += "element face " + std::to_string(triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + positions.size() * 28 + triangles.size() * 13);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    put(bytes, positions[v]);
    if (!normals.empty()) put(bytes, normals[v]);
    if (!strain.empty()) put(bytes, strain[v]);
  }
  for (const Triangle& triangle : triangles) {
    bytes.push_back(3);
    put(bytes, triangle);
  }
  return write_file(file, std::as_bytes(std::span(bytes)));
} catch (...) {
  return caught("the mesh");
}

Result<void> write_glb(const std::filesystem::path& file, const RenderMesh& mesh) try {
  using json = nlohmann::json;
  const std::size_t vertices = mesh.positions.size();
  if (mesh.triangles.empty() || vertices == 0)
    return fail(file.string(), " is not written: a mesh of ", vertices, " vertices and ", mesh.triangles.size(),
                " triangles has nothing to draw");
  if (Result<void> checked = check_length(file, "normals", mesh.normals.size(), vertices); !checked) return checked;
  if (Result<void> checked = check_length(file, "texture coordinates", mesh.uvs.size(), vertices); !checked) return checked;
  if (Result<void> checked = check_indices(file, mesh.triangles, vertices); !checked) return checked;

  constexpr int float_type = 5126, integer_type = 5125, vertex_target = 34962, index_target = 34963;
  std::string binary;
  JsonTree accessors = json::array(), views = json::array();
  const auto add = [&](auto values, int component, const char* type, std::size_t count, int target) {
    JsonTree view = object_of("buffer", 0, "byteOffset", binary.size(), "byteLength", values.size_bytes(), "target", target);
    JsonTree accessor = object_of("bufferView", views.root.size(), "componentType", component, "count", count, "type", type);
    views.root.push_back(std::move(view.root));
    accessors.root.push_back(std::move(accessor.root));
    put_all(binary, values);
    return accessors.root.size() - 1;
  };
  JsonTree shown = json::object();
  json& attributes = shown.root;
  attributes["POSITION"] = add(std::span<const Vec3>(mesh.positions), float_type, "VEC3", vertices, vertex_target);
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  for (const auto& [key, bound] : {std::pair{"min", low}, std::pair{"max", high}}) {
    json& place = accessors.root.back()[key];
    place = {bound.x, bound.y, bound.z};
  }
  if (!mesh.normals.empty()) attributes["NORMAL"] = add(std::span<const Vec3>(mesh.normals), float_type, "VEC3", vertices, vertex_target);
  if (!mesh.uvs.empty()) attributes["TEXCOORD_0"] = add(std::span<const Vec2>(mesh.uvs), float_type, "VEC2", vertices, vertex_target);
  const std::size_t indices =
      add(std::span<const Triangle>(mesh.triangles), integer_type, "SCALAR", mesh.triangles.size() * 3, index_target);

  JsonTree look = object_of("metallicFactor", 0, "roughnessFactor", 0.8);
  JsonTree materials = list_of(object_of("doubleSided", true, "pbrMetallicRoughness", std::move(look)));
  JsonTree primitives = list_of(object_of("attributes", std::move(shown), "indices", indices, "material", 0));
  const JsonTree document = object_of(
      "asset", object_of("version", "2.0", "generator", "Weft"), "scene", 0, "scenes", list_of(object_of("nodes", list_of(json(0)))),
      "nodes", list_of(object_of("mesh", 0)), "materials", std::move(materials), "meshes",
      list_of(object_of("primitives", std::move(primitives))), "accessors", std::move(accessors), "bufferViews", std::move(views),
      "buffers", list_of(object_of("byteLength", binary.size())));

  std::string text = document.root.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t size = 12 + 8 + text.size() + 8 + binary.size();
  if (size > 0xffffffffu)
    return fail(file.string(), " is not written: it would have ", size, " bytes, and a GLB has at most ", 0xffffffffu);
  std::string bytes = "glTF";
  for (const std::size_t value : {std::size_t{2}, size, text.size()}) put(bytes, static_cast<std::uint32_t>(value));
  bytes += "JSON" + text;
  put(bytes, static_cast<std::uint32_t>(binary.size()));
  bytes.append("BIN\0", 4);
  bytes += binary;
  return write_file(file, std::as_bytes(std::span(bytes)));
} catch (...) {
  return caught("the mesh");
}

}   // namespace weft
