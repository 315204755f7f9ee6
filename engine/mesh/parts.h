// Declarations that the mesh sources share; internal to them.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
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

/// The geometry of a glTF or GLB file as a small GLB in memory: one scene's nodes, triangle meshes, float attributes, one
/// buffer, and nothing else. Every length and index in it has been checked. `folder` is where the file's relative URIs start
/// from.
/// Errors: not JSON, nested too deeply, cut short, a reference or a range out of bounds, a required extension, sparse or quantised
/// accessors.
Result<std::string> gltf_geometry(const std::string& content, const std::filesystem::path& folder);

/// The geometry of an OBJ file as another OBJ: v, vt, vn and f only, indices positive and in range. The elements left out are
/// counted.
/// Errors: a line that does not read as what it claims to be, an index without its vertex, no face.
struct ObjGeometry {
  std::string text;
  std::size_t points = 0, lines = 0;
};
Result<ObjGeometry> obj_geometry(std::string_view content);

/// The whole file. Errors: missing, a folder, empty, unreadable.
Result<std::string> read_file(const std::filesystem::path& file);

}  // namespace weft::parts
