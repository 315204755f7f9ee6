// PLY, OBJ and GLB, written by hand.
#include "engine/export.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <span>
#include <string>
#include <utility>

#include "compute/file.h"
#include "engine/mesh/glb.h"
#include "engine/mesh/number_text.h"

namespace weft {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");
static_assert(sizeof(Vec3) == 12 && sizeof(Vec2) == 8 && sizeof(Triangle) == 12);

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// A line a vertex: "v 1 2 3". In pieces that are filled and handed on while they are in the processor's cache.
template <class Vector>
Result<void> put_lines(std::string_view keyword, std::span<const Vector> list, const parts::PutText& put) {
  constexpr std::size_t kPiece = 1 << 16, kNumbers = sizeof(Vector) / sizeof(float), kLongest = 3 + kNumbers * (1 + parts::kNumberLength);
  std::array<char, kPiece> piece;
  char* at = piece.data();
  const auto hand_on = [&] { return put({piece.data(), static_cast<std::size_t>(std::exchange(at, piece.data()) - piece.data())}); };
  for (const Vector& vector : list) {
    if (static_cast<std::size_t>(at - piece.data()) > kPiece - kLongest)
      if (Result<void> done = hand_on(); !done) return done;
    at = std::copy(keyword.begin(), keyword.end(), at);
    for (const float number : std::bit_cast<std::array<float, kNumbers>>(vector)) {
      *at++ = ' ';
      at = parts::put_number(number, at);
    }
    *at++ = '\n';
  }
  return hand_on();
}

parts::PutText adding_to(std::string& text) {
  return [&text](std::string_view piece) {
    text += piece;
    return Result<void>();
  };
}

}   // namespace

namespace parts {

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

std::string ply_of(std::span<const Vec3> positions, std::span<const Vec3> normals, std::span<const float> strain,
                   std::span<const Triangle> triangles) {
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
  return bytes;
}

ObjFaces obj_faces(std::span<const Vec2> uvs, std::span<const Triangle> triangles, bool has_normals) {
  ObjFaces text;
  std::vector<Vec2> upward(uvs.begin(), uvs.end());
  for (Vec2& uv : upward) uv.y = 1 - uv.y;
  const Result<void> added = put_lines("vt", std::span<const Vec2>(upward), adding_to(text.uvs));
  assert(added);
  for (const Triangle& triangle : triangles) {
    text.faces.push_back('f');
    for (const std::uint32_t v : triangle) {
      const std::string number = std::to_string(v + 1);
      text.faces += ' ' + number;
      if (!uvs.empty() || has_normals) text.faces += '/';
      if (!uvs.empty()) text.faces += number;
      if (has_normals) text.faces += '/' + number;
    }
    text.faces.push_back('\n');
  }
  return text;
}

Result<void> put_obj(std::span<const Vec3> positions, std::span<const Vec3> normals, const ObjFaces& faces, const PutText& put) {
  if (Result<void> done = put("# Weft\n"); !done) return done;
  if (Result<void> done = put_lines("v", positions, put); !done) return done;
  if (Result<void> done = put(faces.uvs); !done) return done;
  if (Result<void> done = put_lines("vn", normals, put); !done) return done;
  return put(faces.faces);
}

}   // namespace parts

Result<void> write_ply(const std::filesystem::path& file, std::span<const Vec3> positions, std::span<const Vec3> normals,
                       std::span<const float> strain, std::span<const Triangle> triangles) try {
  if (Result<void> checked = parts::check_length(file, "normals", normals.size(), positions.size()); !checked) return checked;
  if (Result<void> checked = parts::check_length(file, "strains", strain.size(), positions.size()); !checked) return checked;
  if (Result<void> checked = parts::check_indices(file, triangles, positions.size()); !checked) return checked;

  const std::string bytes = parts::ply_of(positions, normals, strain, triangles);
  return write_file(file, std::as_bytes(std::span(bytes)));
} catch (...) {
  return caught("the mesh");
}

Result<void> write_obj(const std::filesystem::path& file, std::span<const Vec3> positions, std::span<const Vec3> normals,
                       std::span<const Vec2> uvs, std::span<const Triangle> triangles) try {
  if (Result<void> checked = parts::check_length(file, "normals", normals.size(), positions.size()); !checked) return checked;
  if (Result<void> checked = parts::check_length(file, "texture coordinates", uvs.size(), positions.size()); !checked) return checked;
  if (Result<void> checked = parts::check_indices(file, triangles, positions.size()); !checked) return checked;

  std::string text;
  const parts::ObjFaces faces = parts::obj_faces(uvs, triangles, !normals.empty());
  if (Result<void> done = parts::put_obj(positions, normals, faces, adding_to(text)); !done) return done;
  return write_file(file, std::as_bytes(std::span(text)));
} catch (...) {
  return caught("the mesh");
}

Result<void> write_glb(const std::filesystem::path& file, const RenderMesh& mesh) try {
  Result<glb::Scene> scene = glb::scene_of(file, mesh);
  if (!scene) return scene.take_error();
  JsonTree document = glb::document_of(*scene, scene->binary.size(), "");
  put(document, "accessors", std::move(scene->accessors));
  std::string text = document.root.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t size = glb::kHeadBytes + text.size() + glb::kBinaryHeadBytes + scene->binary.size();
  if (size > glb::kMostBytes)
    return fail(file.string(), " is not written: it would have ", size, " bytes, and a GLB has at most ", glb::kMostBytes);
  const std::string bytes =
      glb::head_of(text.size(), scene->binary.size()) + text + glb::binary_head_of(scene->binary.size()) + scene->binary;
  return write_file(file, std::as_bytes(std::span(bytes)));
} catch (...) {
  return caught("the mesh");
}

}   // namespace weft
