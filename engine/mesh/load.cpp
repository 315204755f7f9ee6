// Reads files into render meshes, through assimp. assimp only decodes (and triangulates polygons); welding, repair and everything
// else that decides what the cloth is happens in engine/mesh/weld.cpp, the same for every format.
#include <algorithm>
#include <array>
#include <bit>
#include <fstream>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <limits>

#include "engine/mesh/parts.h"

namespace weft {
namespace parts {

Result<std::string> read_file(const std::filesystem::path& file) {
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status)) return fail(file.string(), " does not exist");
  if (std::filesystem::is_directory(status)) return fail(file.string(), " is a folder, not a file");
  if (!std::filesystem::is_regular_file(status)) return fail(file.string(), " is not a regular file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail(file.string(), " cannot be opened for reading");
  std::string content(static_cast<std::size_t>(std::filesystem::file_size(file, code)), '\0');
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (code || stream.gcount() != static_cast<std::streamsize>(content.size())) return fail(file.string(), " cannot be read");
  if (content.empty()) return fail(file.string(), " is empty");
  return content;
}

}   // namespace parts

namespace {

using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using parts::narrow;

/// What was read, and what was left out on the way.
struct Harvest {
  RenderMesh render;
  std::size_t points = 0, lines = 0, bad_normals = 0, bad_uvs = 0, bad_indices = 0;
  bool too_many = false;
};

Vector3d wide(const aiVector3D& v) { return {v.x, v.y, v.z}; }

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
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) {
      ++(face.mNumIndices == 1 ? harvest.points : harvest.lines);
      continue;
    }
    Triangle triangle;
    bool inside = true;
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned v = face.mIndices[side < 0 ? 2 - k : k];
      inside &= v < mesh.mNumVertices;
      triangle[k] = static_cast<std::uint32_t>(base + v);
    }
    if (inside)
      render.triangles.push_back(triangle);
    else
      ++harvest.bad_indices;
  }
  if (!(mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) || !mesh.HasPositions()) return;
  if (base + mesh.mNumVertices > kMostVertices) {
    harvest.too_many = true;
    return;
  }
  // The cofactors are the inverse transpose times the determinant, and exist for a flattening transform too.
  Matrix3d cofactors;
  cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)), linear.col(0).cross(linear.col(1));
  const float missing = std::numeric_limits<float>::quiet_NaN();
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    render.positions.push_back(narrow(place * wide(mesh.mVertices[v])));
    Vec3 normal;
    if (mesh.HasNormals()) {
      normal = narrow((side * (cofactors * wide(mesh.mNormals[v]))).normalized());
      harvest.bad_normals += !parts::finite(normal) || normal == Vec3{};
    }
    render.normals.push_back(normal);
    Vec2 uv{missing, missing};
    if (mesh.HasTextureCoords(0)) {
      uv = {mesh.mTextureCoords[0][v].x, 1 - mesh.mTextureCoords[0][v].y};   // assimp counts v upwards, whatever the format
      harvest.bad_uvs += !parts::finite(uv);
    }
    render.uvs.push_back(uv);
    Vec4 tangent;
    if (mesh.HasNormals() && mesh.HasTangentsAndBitangents()) {
      const Vec3 along = narrow((linear * wide(mesh.mTangents[v])).normalized());
      const double hand = wide(mesh.mNormals[v]).cross(wide(mesh.mTangents[v])).dot(wide(mesh.mBitangents[v])) < 0 ? -1 : 1;
      tangent = {along.x, along.y, along.z, static_cast<float>(side * hand)};
    }
    render.tangents.push_back(tangent);
  }
}

Harvest gather(const aiScene& scene) {
  struct Visit {
    const aiNode* node;
    Affine3d parent;
  };
  Harvest harvest;
  std::vector<Visit> stack{{scene.mRootNode, Affine3d::Identity()}};
  while (!stack.empty() && !harvest.too_many) {
    const auto [node, parent] = stack.back();
    stack.pop_back();
    const Affine3d place = parent * wide(node->mTransformation);
    for (unsigned m = 0; m < node->mNumMeshes && !harvest.too_many; ++m) append(*scene.mMeshes[node->mMeshes[m]], place, harvest);
    for (unsigned c = node->mNumChildren; c-- > 0;) stack.push_back({node->mChildren[c], place});   // the first child is taken next
  }
  return harvest;
}

/// OBJ and primitives without indices arrive with a vertex for every corner of every face. Vertices that agree to the last bit are
/// one vertex: less to draw, and tangents get neighbours to be smooth with.
void join_copies(RenderMesh& render) {
  struct Key {
    std::array<std::uint32_t, 12> bits;
    std::uint32_t vertex;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<Key> keys(render.positions.size());
  for (std::uint32_t v = 0; v < keys.size(); ++v) {
    const Vec3 p = render.positions[v], n = render.normals[v];
    const Vec4 t = render.tangents[v];
    const Vec2 uv = render.uvs[v];
    keys[v] = {
        std::bit_cast<std::array<std::uint32_t, 12>>(std::array<float, 12>{p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y, t.z, t.w, uv.x, uv.y}),
        v};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> first(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    first[keys[i].vertex] = i > 0 && keys[i].bits == keys[i - 1].bits ? first[keys[i - 1].vertex] : keys[i].vertex;

  std::uint32_t kept = 0;
  std::vector<std::uint32_t> renamed(first.size());
  for (std::uint32_t v = 0; v < first.size(); ++v) {
    if (first[v] != v) {
      renamed[v] = renamed[first[v]];
      continue;
    }
    render.positions[kept] = render.positions[v];
    render.normals[kept] = render.normals[v];
    render.tangents[kept] = render.tangents[v];
    render.uvs[kept] = render.uvs[v];
    renamed[v] = kept++;
  }
  render.positions.resize(kept);
  render.normals.resize(kept);
  render.tangents.resize(kept);
  render.uvs.resize(kept);
  for (Triangle& triangle : render.triangles)
    for (std::uint32_t& v : triangle) v = renamed[v];
}

Result<Mesh> load(const std::filesystem::path& file) {
  std::string kind = file.extension().string();
  for (char& c : kind) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  Result<std::string> content = parts::read_file(file);
  if (!content) return content.take_error();
  std::array<std::size_t, 2> left_out{};   // points and lines
  if (kind == ".gltf" || kind == ".glb") {
    content = parts::gltf_geometry(*content, file.parent_path());
    if (!content) return fail(file.string(), ": ", content.why());
    kind = ".glb";
  } else if (kind == ".obj") {
    Result<parts::ObjGeometry> geometry = parts::obj_geometry(*content);
    if (!geometry) return fail(file.string(), ": ", geometry.why());
    content = std::move(geometry->text);
    left_out = {geometry->points, geometry->lines};
  } else {
    return fail(file.string(), " has the extension \"", kind, "\"; .gltf, .glb and .obj can be read");
  }

  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(content->data(), content->size(), aiProcess_Triangulate, kind.c_str() + 1);
  if (!scene || !scene->mRootNode) {
    const std::string reason = importer.GetErrorString();
    return fail(file.string(), " cannot be read as ", kind.substr(1), ": ", reason.empty() ? "it has no geometry" : reason);
  }
  Harvest harvest = gather(*scene);
  if (harvest.too_many) return fail(file.string(), " has more than ", kMostVertices, " vertices");
  if (harvest.bad_indices)
    return fail(file.string(), ": ", harvest.bad_indices, " triangles point past the last vertex of their primitive");
  if (kind == ".obj" || harvest.render.positions.size() >= 3 * harvest.render.triangles.size()) join_copies(harvest.render);
  Result<Mesh> mesh = weld_mesh(std::move(harvest.render));
  if (!mesh) return fail(file.string(), ": ", mesh.why());

  const auto note = [&](std::size_t count, const char* one, const char* many, const char* what) {
    if (count) mesh->mended.insert(mesh->mended.begin(), fail(count, " ", count == 1 ? one : many, what).message);
  };
  note(harvest.bad_uvs, "texture coordinate was", "texture coordinates were", " not finite; projected instead");
  note(harvest.bad_normals, "normal was", "normals were", " not finite or had no direction; made anew");
  note(harvest.lines + left_out[1], "line was", "lines were", " left out");
  note(harvest.points + left_out[0], "point was", "points were", " left out");
  return mesh;
}

}   // namespace

Result<Mesh> load_mesh(const std::filesystem::path& file) try {
  // assimp throws on some damaged files, and memory can run out on any; no exception may leave this function.
  try {
    return load(file);
  } catch (const std::exception& problem) {
    return fail(file.string(), " cannot be read: ", problem.what());
  }
} catch (...) {
  return caught("the mesh");
}

}   // namespace weft
