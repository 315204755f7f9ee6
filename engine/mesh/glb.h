// What GLBs have in common, whether they hold a mesh or its animation. Internal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "engine/json_tree.h"
#include "engine/mesh.h"

namespace weft::glb {

inline constexpr int kFloat = 5126, kInteger = 5125;                  // component types
inline constexpr int kVertexTarget = 34962, kIndexTarget = 34963;     // of buffer views
inline constexpr std::uint64_t kMostBytes = 0xffffffffu;

/// One node with one mesh, with a primitive for each of its materials; without any, double-sided and without textures. `binary` begins
/// with its arrays, each 4-byte aligned.
struct Scene {
  std::string binary;
  JsonTree accessors = nlohmann::json::array(), views = nlohmann::json::array(), primitives = nlohmann::json::array();
  JsonTree materials = nlohmann::json::object();   // with textures, samplers and images, and the extensions that they use
};

/// Positions with their bounds, normals and texture coordinates where there are some, indices, materials. Errors: nothing to draw, lists of
/// unequal length, indices out of range.
Result<Scene> scene_of(const std::filesystem::path& file, const RenderMesh& mesh);

/// All but the accessors: these are taken out of `scene`, as are the others. `bytes`: of the binary chunk.
JsonTree document_of(Scene& scene, std::uint64_t bytes, std::string_view name);

/// The file's first bytes, up to the JSON text; its length is divisible by 4.
std::string head_of(std::uint64_t text_bytes, std::uint64_t binary_bytes);
inline constexpr std::uint64_t kHeadBytes = 20;
/// What stands between the JSON text and the arrays.
std::string binary_head_of(std::uint64_t binary_bytes);
inline constexpr std::uint64_t kBinaryHeadBytes = 8;

}  // namespace weft::glb

namespace weft::parts {

/// What is wrong with a list that is to have an entry a vertex, or none; and with indices.
Result<void> check_length(const std::filesystem::path& file, const char* name, std::size_t count, std::size_t vertices);
Result<void> check_indices(const std::filesystem::path& file, std::span<const Triangle> triangles, std::size_t vertices);

/// What write_ply and write_obj write, of lists that they have found good.
std::string ply_of(std::span<const Vec3> positions, std::span<const Vec3> normals, std::span<const float> strain,
                   std::span<const Triangle> triangles);
struct ObjFaces {   // what stays the same when vertices move
  std::string uvs, faces;
};
ObjFaces obj_faces(std::span<const Vec2> uvs, std::span<const Triangle> triangles, bool has_normals);
/// Piece by piece, so that what is written is in the processor's cache still. Errors: those of `put`.
using PutText = std::function<Result<void>(std::string_view piece)>;
Result<void> put_obj(std::span<const Vec3> positions, std::span<const Vec3> normals, const ObjFaces& faces, const PutText& put);

}  // namespace weft::parts
