// PLY, STL, Collada and FBX, by assimp. Its readers are many and trust their files: damaged ones make them crash, run for ever or ask for
// any memory. So they work in a process of their own (engine/mesh/apart.h), which sends back a GLB; that is read as any other.
#include <assimp/Importer.hpp>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <cmath>
#include <iterator>
#include <set>

#include "engine/mesh/apart.h"
#include "engine/mesh/glb.h"
#include "engine/mesh/gltf.h"
#include "engine/mesh/parts.h"

namespace weft::parts {

std::size_t GltfWriter::add_values(const std::string& values, std::size_t count, int component, const char* type) {
  const std::size_t view = views_.root.size();
  add(views_, object_of("buffer", 0, "byteOffset", bytes_.size(), "byteLength", values.size()));
  add(accessors_, object_of("bufferView", view, "componentType", component, "count", count, "type", type));
  bytes_ += values;
  return accessors_.root.size() - 1;
}

std::size_t GltfWriter::add_node(JsonTree node, std::size_t parent) {
  if (parent != kNone && !nodes.root[parent].contains("children")) nodes.root[parent].emplace("children", json::array());
  (parent == kNone ? tops_.root : nodes.root[parent]["children"]).push_back(nodes.root.size());
  add(nodes, std::move(node));
  return nodes.root.size() - 1;
}

void GltfWriter::add(JsonTree& list, JsonTree entry) { list.root.push_back(std::move(entry.root)); }

std::string GltfWriter::finish() {
  const JsonTree document = object_of(
      "asset", object_of("version", "2.0"), "scene", 0, "buffers", list_of(object_of("byteLength", bytes_.size())), "bufferViews",
      std::move(views_), "accessors", std::move(accessors_), "meshes", std::move(meshes), "nodes", std::move(nodes), "materials",
      std::move(materials), "scenes", list_of(object_of("nodes", std::move(tops_))));
  std::string text = document.root.dump(-1, ' ', false, json::error_handler_t::replace);   // names may be anything
  text.resize((text.size() + 3) / 4 * 4, ' ');
  return glb::head_of(text.size(), bytes_.size()) + text + glb::binary_head_of(bytes_.size()) + bytes_;
}

namespace {

constexpr unsigned kPoint = 1, kLine = 2, kTriangle = 3;   // corners

/// Makes a GLB of what assimp has read.
class Scribe {
 public:
  Scribe(const aiScene& scene, bool has_normals) : scene_(scene), has_normals_(has_normals) {}

  std::string write() {
    for (unsigned m = 0; m < scene_.mNumMaterials; ++m) add_material(*scene_.mMaterials[m]);
    for (unsigned m = 0; m < scene_.mNumMeshes; ++m) add_mesh(*scene_.mMeshes[m]);
    add_node(*scene_.mRootNode, out_.add_node(object_of("matrix", to_metres_and_y_up()), kNone));
    return out_.finish();
  }

 private:
  // What an FBX says of its unit, in cm, and of its axes. assimp sees to both in a Collada itself.
  JsonTree to_metres_and_y_up() const {
    float unit = 100;
    int axes[3] = {0, 1, 2}, signs[3] = {1, 1, 1};
    if (const aiMetadata* data = scene_.mMetaData) {
      data->Get("UnitScaleFactor", unit);
      constexpr const char* names[3][2] = {{"CoordAxis", "CoordAxisSign"}, {"UpAxis", "UpAxisSign"}, {"FrontAxis", "FrontAxisSign"}};
      for (int k = 0; k < 3; ++k) data->Get(names[k][0], axes[k]), data->Get(names[k][1], signs[k]);
    }
    if (!(unit > 0 && unit < 1e9f)) unit = 100;
    const std::set<int> all(std::begin(axes), std::end(axes));
    const bool are_axes = all == std::set<int>{0, 1, 2};
    JsonTree matrix(json::array());
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row) {
        const bool here = row == 3 || column == 3 ? row == column : (are_axes ? axes[row] : row) == column;
        const double size = row == 3 ? 1 : double(unit) / 100 * (are_axes && signs[row] < 0 ? -1 : 1);
        matrix.root.push_back(here ? size : 0.0);
      }
    return matrix;
  }

  void add_material(const aiMaterial& material) {
    aiString name;
    aiColor3D colour(0.8f, 0.8f, 0.8f);
    material.Get(AI_MATKEY_NAME, name);
    material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
    JsonTree factors(json::array());
    for (const float part : {colour.r, colour.g, colour.b, 1.f}) factors.root.push_back(std::isfinite(part) ? part : 0.8f);
    JsonTree look = object_of("baseColorFactor", std::move(factors), "metallicFactor", 0, "roughnessFactor", 0.8);
    JsonTree written = object_of("name", std::string(name.C_Str()), "doubleSided", true, "pbrMetallicRoughness", std::move(look));
    out_.materials.root.push_back(std::move(written.root));
  }

  template <class T>
  std::size_t add(unsigned count, const char* type, const std::function<T(unsigned)>& at) {
    std::string bytes;
    for (unsigned v = 0; v < count; ++v) {
      const T value = at(v);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    return out_.add_values(bytes, count, 5126, type);
  }

  // A primitive for each of points, lines and triangles.
  void add_mesh(const aiMesh& mesh) {
    auto attributes = [&, position = kNone, normal = kNone, uv = kNone, colour = kNone]() mutable {
      const auto vector = [](const aiVector3D& v) { return Vec3{v.x, v.y, v.z}; };
      const unsigned count = mesh.mNumVertices;
      if (position == kNone) {
        position = narrow_number(add<Vec3>(count, "VEC3", [&](unsigned v) { return vector(mesh.mVertices[v]); }));
        if (has_normals_ && mesh.HasNormals())
          normal = narrow_number(add<Vec3>(count, "VEC3", [&](unsigned v) { return vector(mesh.mNormals[v]); }));
        if (mesh.HasTextureCoords(0))   // assimp's point up
          uv = narrow_number(add<Vec2>(count, "VEC2", [&](unsigned v) {
            const aiVector3D& at = mesh.mTextureCoords[0][v];
            return Vec2{at.x, 1 - at.y};
          }));
        if (mesh.HasVertexColors(0))
          colour = narrow_number(add<Vec4>(count, "VEC4", [&](unsigned v) {
            const aiColor4D& c = mesh.mColors[0][v];
            return Vec4{c.r, c.g, c.b, c.a};
          }));
      }
      JsonTree all = object_of("POSITION", position);
      if (normal != kNone) put(all, "NORMAL", normal);
      if (uv != kNone) put(all, "TEXCOORD_0", uv);
      if (colour != kNone) put(all, "COLOR_0", colour);
      return all;
    };
    JsonTree primitives(json::array());
    for (const auto& [corners, mode] : {std::pair{kTriangle, 4}, {kLine, 1}, {kPoint, 0}}) {
      std::string indices;
      for (unsigned f = 0; f < mesh.mNumFaces; ++f)
        if (const aiFace& face = mesh.mFaces[f]; face.mNumIndices == corners)
          indices.append(reinterpret_cast<const char*>(face.mIndices), corners * sizeof(unsigned));
      if (indices.empty() || mesh.mNumVertices == 0) continue;
      const std::size_t list = out_.add_values(indices, indices.size() / sizeof(unsigned), 5125, "SCALAR");
      JsonTree primitive = object_of("attributes", attributes(), "indices", list, "mode", mode);
      if (mesh.mMaterialIndex < scene_.mNumMaterials) put(primitive, "material", mesh.mMaterialIndex);
      primitives.root.push_back(std::move(primitive.root));
    }
    JsonTree written = object_of("primitives", std::move(primitives));
    out_.meshes.root.push_back(std::move(written.root));
  }

  static std::uint32_t narrow_number(std::size_t number) { return static_cast<std::uint32_t>(number); }

  // A node for each mesh, below that of the scene.
  void add_node(const aiNode& node, std::size_t parent) {
    const aiMatrix4x4& m = node.mTransformation;
    JsonTree matrix(json::array());
    for (unsigned column = 0; column < 4; ++column)
      for (unsigned row = 0; row < 4; ++row) matrix.root.push_back(m[row][column]);
    const std::size_t number = out_.add_node(object_of("matrix", std::move(matrix)), parent);
    for (unsigned k = 0; k < node.mNumMeshes; ++k) out_.add_node(object_of("mesh", node.mMeshes[k]), number);
    for (unsigned k = 0; k < node.mNumChildren; ++k) add_node(*node.mChildren[k], number);
  }

  const aiScene& scene_;
  bool has_normals_;
  GltfWriter out_;
};

/// What is in it and not read, and what is done to it: a part of a sentence.
std::string note_on(const aiScene& scene, bool is_stl) {
  std::size_t joints = 0, corners = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) joints += scene.mMeshes[m]->mNumBones, corners += scene.mMeshes[m]->mNumVertices;
  std::string note;
  if (joints > 0 || scene.mNumAnimations > 0)
    note = fail(joints, " joints and ", scene.mNumAnimations, " animations were left out: a skin is read from glTF alone").message;
  if (!is_stl) return note;
  note += fail(note.empty() ? "" : "; ", corners, " corners of an STL, which has no shared vertices, were joined where they meet").message;
  return note;
}

}  // namespace

Result<Harvest> read_foreign(const std::string& content, const std::string& kind) {
  const bool is_stl = kind == "stl";
  const Bounds bounds{(std::size_t{256} << 20) + 64 * content.size(), static_cast<unsigned>(3 + content.size() / (1 << 20))};
  Result<std::string> read = apart("assimp", bounds, [&]() -> Result<std::string> {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFileFromMemory(content.data(), content.size(), aiProcess_Triangulate, kind.c_str());
    if (!scene || !scene->mRootNode) return fail("assimp cannot read it: ", importer.GetErrorString());
    return note_on(*scene, is_stl) + "\n" + Scribe(*scene, !is_stl).write();   // an STL's normals are its triangles'
  });
  if (!read) return read.take_error();
  const std::size_t line = read->find('\n');
  Result<Harvest> harvest = read_gltf(read->substr(line + 1), {}, BufferFiles::below_its_folder);
  if (harvest) harvest->note = read->substr(0, line);
  return harvest;
}

}  // namespace weft::parts
