// Declarations that the mesh sources share; internal to them.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compute/result.h"
#include "engine/mesh.h"

namespace weft::parts {

inline Eigen::Vector3d wide(Vec3 v) { return {v.x, v.y, v.z}; }
inline Vec3 narrow(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
inline Eigen::Quaterniond wide(const Rotation& r) { return Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized(); }
inline Rotation narrow(const Eigen::Quaterniond& q) {
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()), static_cast<float>(q.w())};
}
inline Eigen::Affine3d wide(const Affine& m) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  result.linear() << wide(m.x), wide(m.y), wide(m.z);
  result.translation() = wide(m.origin);
  return result;
}
inline Affine narrow(const Eigen::Affine3d& m) {
  const auto column = [&](int k) { return narrow(Eigen::Vector3d(m.matrix().col(k).head<3>())); };
  return {column(0), column(1), column(2), column(3)};
}
inline bool finite(Vec2 v) { return std::isfinite(v.x) && std::isfinite(v.y); }
inline bool finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

inline constexpr double kWeldFraction = 1e-6;    // of the diagonal: above float rounding (6e-8), far below any cloth's edge length
inline constexpr double kAreaFraction = 1e-12;   // of the diagonal squared: the area of a triangle one weld tolerance wide and long

/// One side of an edge: triangle `triangle` runs from `low` to `high` (forward) or back, and has `across` as its third point.
struct HalfEdge {
  std::uint32_t low, high, triangle, across;
  bool forward;
};

/// All half-edges (three a triangle), sorted by (low, high), those of one edge in the order of their triangles.
std::vector<HalfEdge> half_edges(std::span<const Triangle> triangles);

/// The end of the run of half-edges that starts at `begin` and lies on one edge.
std::size_t run_end(std::span<const HalfEdge> halves, std::size_t begin);

/// Which triangles to turn so that neighbours run the same way round.
struct Orientation {
  std::vector<std::uint32_t> turn;    // triangles, ascending; the minority of each connected piece
  std::uint32_t twisted_pieces = 0;   // pieces that cannot be oriented, such as a Moebius strip; turned as far as that goes
};
Orientation orient(std::span<const Triangle> triangles);

/// Fill what is missing or not finite; the contract is at weld_mesh.
void complete_normals(RenderMesh& render, std::span<const std::uint32_t> point_of, std::span<const Vec3> points,
                      std::span<const Triangle> triangles);
void complete_uvs(RenderMesh& render);
void complete_tangents(RenderMesh& render);

/// What a file holds, before it is welded: vertices in the file's order, and counts of what was left out or is made anew.
struct Harvest {
  RenderMesh render;                 // a normal or tangent that is missing is zero, a texture coordinate not finite
  std::size_t source_vertices = 0;   // the file's own, the first of `render`; copies of an OBJ's come after them
  std::size_t points = 0, lines = 0, skins = 0, morph_targets = 0;
  std::size_t bad_normals = 0, bad_uvs = 0, crossed_faces = 0, other_coordinates = 0;
  std::optional<Skin> skin;          // over the file's own vertices, as these are
  std::map<std::string, std::vector<Vec4>> attributes;
  std::string skin_fault, attribute_fault, material_fault;   // why one was left out
  std::string note;                  // what else is to be said
};

/// A glTF or GLB file's scene. `folder` is where the file's relative URIs start from, and nothing outside it is read.
/// Errors: not JSON, too large or nested too deeply, cut short, a reference or a range out of bounds, a required extension, indices that
/// make no whole triangles, too many vertices, triangles, nodes or sets of accessors; compressed, in a Weft without what unpacks it.
Result<Harvest> read_gltf(const std::string& content, const std::filesystem::path& folder, BufferFiles buffer_files);

/// An OBJ file's faces.
/// Errors: a line that does not read as what it claims to be, an index without its vertex, too many corners or vertices, no face.
Result<Harvest> read_obj(std::string_view content);

/// A PLY, STL, Collada or FBX file, as assimp reads it; `kind` is its ending, without the dot.
/// Errors: assimp's sentence, or that it did not come to an end with the memory and the time that a file of this size needs.
Result<Harvest> read_foreign(const std::string& content, const std::string& kind);

/// Whether a skin of a mesh of so many points is what Skin says; else a sentence.
Result<void> check_skin(const Skin& skin, std::size_t points);

/// Whether all are finite and nearer than kTooLarge (engine/finite.h); else a sentence with the first that is not.
Result<void> check_places(std::span<const Vec3> positions);

/// Whether each triangle has a material that is there, or none; else a sentence.
Result<void> check_materials(const RenderMesh& render);

/// Sets Mesh::loose, from where the file has its vertices.
void keep_loose(Mesh& mesh, std::span<const Vec3> source);

/// Cuts a face of three or more corners into triangles over these, which keep its winding; every corner is one of a triangle. False
/// when the face crosses itself: then triangles lie on each other, or face the other way.
bool cut_face(std::span<const Vec3> face, std::vector<Triangle>& triangles);

/// A file, or no more than its first bytes. Errors: missing, a folder, empty, unreadable; a whole file of more than kMostBytes.
inline constexpr std::size_t kMostBytes = std::size_t{1} << 30;   // three times what 4,000,000 vertices need as an OBJ
Result<std::string> read_file(const std::filesystem::path& file, std::optional<std::size_t> first_bytes = std::nullopt);

}  // namespace weft::parts
