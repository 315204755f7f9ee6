// The last step of reading a glTF: assimp decodes the GLB that engine/mesh/gltf.cpp has checked and written.
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <limits>
#include <string_view>

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
      std::move(views_), "accessors", std::move(accessors_), "meshes", std::move(meshes), "nodes", std::move(nodes), "scenes",
      list_of(object_of("nodes", std::move(tops_))));
  std::string text = document.root.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto put = [](std::string& bytes, std::size_t value) {
    for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<char>(value >> (8 * k)));
  };
  std::string glb = "glTF";
  for (const std::size_t value : {std::size_t{2}, 12 + 8 + text.size() + 8 + bytes_.size(), text.size()}) put(glb, value);
  glb += "JSON" + text;
  put(glb, bytes_.size());
  glb.append("BIN\0", 4);
  return glb + bytes_;
}

namespace {

using Eigen::Affine3d;
using Eigen::Matrix3d;

Eigen::Vector3d wide(const aiVector3D& v) { return {v.x, v.y, v.z}; }

Affine3d wide(const aiMatrix4x4& m) {
  Affine3d result;
  result.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, 0, 0, 0, 1;
  return result;
}

void append(const aiMesh& mesh, const Affine3d& place, Harvest& harvest) {
  RenderMesh& render = harvest.render;
  const std::size_t base = render.positions.size();
  // A mirrored triangle is wound backwards; turned, it faces the way its transformed normals do.
  const Matrix3d linear = place.linear();
  const double side = linear.determinant() < 0 ? -1 : 1;
  for (std::size_t f = triangles_that_name(mesh.mNumVertices); f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;   // none is written; the number of triangles is compared
    Triangle& triangle = render.triangles.emplace_back();
    for (unsigned k = 0; k < 3; ++k) triangle[k] = static_cast<std::uint32_t>(base + face.mIndices[side < 0 ? 2 - k : k]);
  }
  // The cofactors are the inverse transpose times the determinant, and exist for a flattening transform too.
  Matrix3d cofactors;
  cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)), linear.col(0).cross(linear.col(1));
  const float missing = std::numeric_limits<float>::quiet_NaN();
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    render.positions.push_back(narrow(place * wide(mesh.mVertices[v])));
    Vec3& normal = render.normals.emplace_back();
    Vec4& tangent = render.tangents.emplace_back();
    Vec2& uv = render.uvs.emplace_back(Vec2{missing, missing});
    if (mesh.HasTextureCoords(1)) {
      uv = {mesh.mTextureCoords[0][v].x, mesh.mTextureCoords[1][v].x};
      harvest.bad_uvs += !finite(uv);
    }
    if (!mesh.HasNormals()) continue;   // tangents without normals do not count (glTF 2.0, 3.7.2.1)
    normal = narrow((side * (cofactors * wide(mesh.mNormals[v]))).normalized());
    harvest.bad_normals += !finite(normal) || normal == Vec3{};
    if (!mesh.HasTangentsAndBitangents()) continue;
    const Vec3 along = narrow((linear * wide(mesh.mTangents[v])).normalized());
    const double hand = wide(mesh.mNormals[v]).cross(wide(mesh.mTangents[v])).dot(wide(mesh.mBitangents[v])) < 0 ? -1 : 1;
    tangent = {along.x, along.y, along.z, static_cast<float>(side * hand)};
  }
}

/// assimp keeps what was thrown.
void refuse_for_memory(const std::exception_ptr& thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {   // has a sentence
  }
}

Result<Harvest> decode_gltf(GltfGeometry& geometry) {
  struct Visit {
    const aiNode* node;
    Affine3d parent;
  };
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(geometry.glb.data(), geometry.glb.size(), aiProcess_Triangulate, "glb");
  if (!scene || !scene->mRootNode) {
    refuse_for_memory(importer.GetException());
    return fail("assimp cannot read it: ", importer.GetErrorString());
  }
  Harvest harvest;
  std::vector<Visit> stack{{scene->mRootNode, Affine3d::Identity()}};
  while (!stack.empty()) {
    const auto [node, parent] = stack.back();
    stack.pop_back();
    const Affine3d place = parent * wide(node->mTransformation);
    const bool skinned = std::string_view(node->mName.C_Str()) == kSkinned;
    for (unsigned m = 0; m < node->mNumMeshes; ++m)
      append(*scene->mMeshes[node->mMeshes[m]], skinned ? Affine3d::Identity() : place, harvest);
    for (unsigned c = node->mNumChildren; c-- > 0;) stack.push_back({node->mChildren[c], place});   // the first child is taken next
  }
  if (harvest.render.positions.size() != geometry.vertices || harvest.render.triangles.size() != geometry.triangles)
    return fail("assimp read ", harvest.render.positions.size(), " vertices and ", harvest.render.triangles.size(), " triangles of ",
                geometry.vertices, " and ", geometry.triangles);
  harvest.source_vertices = geometry.vertices;
  harvest.points = geometry.points;
  harvest.lines = geometry.lines;
  harvest.skins = geometry.skins;
  harvest.morph_targets = geometry.morph_targets;
  harvest.skin = std::move(geometry.skin);
  harvest.attributes = std::move(geometry.attributes);
  harvest.skin_fault = std::move(geometry.skin_fault);
  harvest.attribute_fault = std::move(geometry.attribute_fault);
  return harvest;
}

}   // namespace

Result<Harvest> read_gltf(const std::string& content, const std::filesystem::path& folder, BufferFiles buffer_files) {
  Result<GltfDocument> document = open_gltf(content, folder, buffer_files);
  if (!document) return document.take_error();
  Result<GltfGeometry> geometry = strip_gltf(*document);
  if (!geometry) return Error{geometry.why()};
  document = Error{};   // assimp needs the memory
  return decode_gltf(*geometry);
}

}   // namespace weft::parts
