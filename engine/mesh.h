// Cloth meshes: what is drawn, what is simulated, and the map between the two.
//
// A file's vertices are split wherever normals or UVs differ. The cloth must not be, so vertices at one place (within
// `weld_tolerance`) become one point; `point_of` maps every render vertex back, and seams stay closed.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "compute/result.h"
#include "engine/scene.h"
#include "engine/vector.h"

namespace weft {

inline constexpr std::uint32_t kNone = 0xffffffffu;

using Triangle = std::array<std::uint32_t, 3>;

/// What the renderer draws: one entry a vertex in all four lists, three indices a triangle.
struct RenderMesh {
  std::vector<Vec3> positions;   // m, rest pose, node transforms applied
  std::vector<Vec3> normals;     // unit
  std::vector<Vec4> tangents;    // unit, w = handedness (+1 or -1)
  std::vector<Vec2> uvs;
  std::vector<Triangle> triangles;
};

/// An edge and what lies on both sides of it, after Baumgart's winged edge (1972).
///
///            across[0]
///             /    \        triangle[0] = (a, b, across[0]), in this order
///            a ---- b
///             \    /        triangle[1] = (b, a, across[1]); kNone on a boundary
///            across[1]
struct WingedEdge {
  std::uint32_t a, b;
  std::array<std::uint32_t, 2> triangle;
  std::array<std::uint32_t, 2> across;
};

struct Mesh {
  RenderMesh render;
  std::vector<std::uint32_t> point_of;      // render vertex -> point
  std::vector<Vec3> points;                 // m, rest pose
  std::vector<Triangle> triangles;          // over points; each valid, no two the same
  std::vector<WingedEdge> edges;            // manifold after mending
  std::vector<std::string> mended;          // one sentence a kind of fault, with its count; empty for a clean mesh
  double weld_tolerance = 0;                // m
};

/// A grid with (cells + 1) vertices a side, plus one a cell in the centre topology. Indices are integers throughout, so
/// counts are exact for every size. UVs run 0 ... 1; vertex (i, j) of the corner lattice is render vertex j (cells_x + 1) + i.
Mesh make_grid(const Grid& grid);

/// Reads glTF, GLB or OBJ: all primitives, node transforms applied, missing normals and UVs made.
/// Errors: missing, cut short or foreign file; no triangle; a vertex that is not finite; more than 4 million vertices.
Result<Mesh> load_mesh(const std::filesystem::path& file);

/// Applies a transform (scale, then rotation, then translation) to positions, normals and tangents.
void transform_mesh(Mesh& mesh, const Transform& transform);

/// Welds and mends; what load_mesh does after reading. `render` needs positions and triangles, the rest is made if it is missing.
Result<Mesh> weld_mesh(RenderMesh render);

/// Winged edges of a triangle list. `non_manifold` receives the number of edges with more than two triangles or with two of
/// the same orientation; the surplus triangles of such an edge are treated as if a boundary ran there.
std::vector<WingedEdge> winged_edges(std::span<const Triangle> triangles, std::uint32_t* non_manifold);

}  // namespace weft
