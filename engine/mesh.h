// Cloth meshes: what is drawn, what is simulated, and the map between the two.
//
// A file's vertices are split wherever normals or UVs differ. The cloth must not be, so vertices at one place (within
// `weld_tolerance`) become one point; `point_of` maps every render vertex back, and seams stay closed.
//
// A file's own vertices keep their numbers, whatever is joined, split or dropped on the way: `point_of_source` is by them, and it is
// them that a scene's anchors count. An OBJ's are its `v` lines. A glTF's are the elements of its position accessors, primitive
// after primitive as the scene's nodes show them; primitives of one mesh that share their accessors share the vertices.
// Render vertices lie in the same order; copies of an OBJ's vertex, with other normals or UVs, come after the last.
//
// Texture coordinates follow glTF and Vulkan: (0, 0) is the picture's upper left corner, v grows downwards. The bitangent
// w cross(normal, tangent) points up in the picture, which is what glTF's normal maps (+Y up) expect.
//
// Limitations: welding goes by position alone, so two sheets that lie exactly on each other become one (their triangles are
// duplicates then, and are counted as such). Of a vertex's joints the four with the largest weights count. Of vertices that
// become one point the first says where morph targets and joints take it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compute/result.h"
#include "engine/scene.h"
#include "engine/vector.h"

namespace weft {

inline constexpr std::uint32_t kNone = 0xffffffffu;

using Triangle = std::array<std::uint32_t, 3>;

/// What a file says of how its triangles look: kept for whoever writes the mesh back (engine/export.h, engine/cache.h), and for pictures
/// of cloths that want it (Appearance::mesh_materials).
struct Materials {
  std::size_t count = 0;
  std::string text;   // JSON: glTF's lists "materials", "textures", "samplers", "images"; an image's "bufferView" is one of `images`
  std::vector<std::string> images;   // PNG, JPEG, WebP or KTX2, as the file holds them
};

/// What the renderer draws: one entry a vertex in all four lists, three indices a triangle.
struct RenderMesh {
  std::vector<Vec3> positions;   // m, rest pose, node transforms applied
  std::vector<Vec3> normals;     // unit
  std::vector<Vec4> tangents;    // unit, at right angles to the normal, w = handedness (+1 or -1)
  std::vector<Vec2> uvs;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> material_of = {};       // of each triangle: a number below materials->count, or kNone; empty: all have none
  std::shared_ptr<const Materials> materials = {};   // none: material_of is empty
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

/// What moves the points of a mesh, as glTF has it: morph targets, a tree of nodes, of which joints are some, and animations that move
/// weights and nodes. First each morph target moves a point by its delta times its weight. Then the point goes where its joints take it, in
/// the mean of their weights (linear blend skinning: Magnenat-Thalmann et al. 1988).
struct Skin {
  struct Node {
    std::uint32_t parent = kNone;   // comes before its children
    Vec3 translation, scale{1, 1, 1};   // m; and with the rotation: scale first, translation last
    Rotation rotation;
    std::optional<Affine> matrix;   // instead of these
  };
  struct Joint {
    std::string name;
    std::uint32_t node = 0;
    Affine inverse_bind;            // from the mesh as the file stores it to the joint's axes
  };
  /// A shape towards which points go by a weight: with 1 they are there. Weights below 0 and above 1 lead on along the same lines.
  struct Morph {
    std::string name;                   // empty where the file has none
    float weight = 0;                   // unless an animation or the host says otherwise
    std::vector<std::uint32_t> points;  // that it moves, growing
    std::vector<Vec3> deltas;           // m, of each of these
    std::vector<Vec3> normal_deltas;    // of their unit normals; empty: it does not turn them
  };
  enum class Moves { translation, rotation, scale, weight };
  enum class Interpolation { step, linear, cubic };
  /// What happens to one figure of one node, or to the weight of one morph target.
  struct Channel {
    std::uint32_t node = 0;         // of `nodes`; with Moves::weight of `morphs`
    Moves moves = Moves::translation;
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> times;       // s, growing
    std::vector<Vec4> values;       // one a time (a rotation is a quaternion, a weight is x); cubic: in-tangent, value and out-tangent of each
  };
  struct Animation {
    std::string name;
    std::vector<Channel> channels;
  };
  static constexpr std::size_t kInfluences = 4;

  std::vector<Node> nodes;
  std::vector<Joint> joints;        // up to 65535; none: nothing is carried, and the host sees one joint for all (only with morph targets)
  std::vector<Morph> morphs;        // up to kMostMorphs
  std::vector<Animation> animations;
  std::vector<std::array<std::uint16_t, kInfluences>> joints_of;   // of each point; these two are empty without joints
  std::vector<std::array<float, kInfluences>> weights;             // of each point: not below 0, their sum is 1
  Affine place;                     // from the file's space to the mesh's: what transform_mesh has done
};

struct Mesh {
  RenderMesh render;
  std::vector<std::uint32_t> point_of;          // render vertex -> point; every point has at least one render vertex
  std::vector<std::uint32_t> point_of_source;   // vertex of the file (or of what weld_mesh was given) -> point; kNone: of no triangle
  std::vector<Vec3> loose;                      // m, rest pose: of the file's vertices that are of no triangle, one after another
  std::vector<Vec3> points;                     // m, rest pose; numbered in the order of their first render vertices, where they lie
  std::vector<Triangle> triangles;              // over points: render.triangles[i] through point_of; each valid, no two the same
  std::vector<WingedEdge> edges;                // manifold after repair; each pair of points once, sorted by (smaller, greater) point
  std::vector<std::string> mended;              // repairs: one sentence a kind of fault, with its count; empty for a clean mesh
  double weld_tolerance = 0;                    // m
  std::uint32_t spare_vertices = 0;             // the last of `render`, of no triangle: for points that are split (split_points)
  std::uint32_t spare_points = 0;               // how many points may still come
  std::optional<Skin> skin;
  std::string skin_fault;                       // why a file's skin was left out; empty: it was not
  /// Of each point, by name: a file's vertex colours (COLOR_0, linear) and its own attributes (_NAME), which a scene's maps name.
  std::map<std::string, std::vector<Vec4>> attributes;
};

/// A grid with (cells + 1) vertices a side, plus one a cell in the centre topology. Indices are integers throughout, so
/// counts are exact for every size. Asserts 1 <= cells <= 2048 and a size above 0.
///
///   upright                           flat, seen from above
///   +y                                -z
///    |  row j = cells_y, v = 0         |  row j = 0, v = 0
///    |                                 |
///    |  row j = 0, v = 1               |  row j = cells_y, v = 1
///    +----------- +x                  +z ---------- +x
///
/// Corner vertex (i, j) is render vertex j (cells_x + 1) + i, at size ((i / cells_x - 1/2), (j / cells_y - 1/2)) along x and
/// y (upright) or x and z (flat): the grid is centred at the origin, faces +z or +y, and a picture on it is not mirrored.
/// The centre of cell (i, j) is render vertex (cells_x + 1)(cells_y + 1) + j cells_x + i. Points and render vertices are the same.
Mesh make_grid(const Grid& grid);

// Of a file: 2000 x 2000, far above what can be simulated. Stops nonsense files early.
inline constexpr std::uint32_t kMostVertices = 4'000'000;

inline constexpr std::uint32_t kMostMorphs = 1024;   // of a mesh: a face for films has some 800

inline constexpr std::uint32_t kMostCorners = 1000;   // of a face: the time that it takes to cut it grows with the square

/// Reads glTF, GLB or OBJ: all triangle primitives of the default scene, node transforms applied (a mirroring one turns the
/// winding back outwards; a skinned mesh has none, as glTF says), missing normals and UVs made; with skins, morph targets, their
/// animations, vertex colours, and materials with their textures. The mesh has its base shape: that of morph targets with weights of 0.
/// Faces of an OBJ are cut into triangles, concave ones too. Lines, points, and skins (with the morph targets), attributes or
/// materials that are not as they must be, are left out, with a sentence in `mended`. Where triangles share no vertices, those that
/// agree in everything are joined. What meshopt or Draco has compressed is unpacked, where Weft was built with them. A glTF's buffers
/// and images are read only below its own folder, links followed, or anywhere; nothing that another file names is.
/// PLY, STL, Collada and FBX: the triangles, vertex colours and plain materials that assimp finds, in metres, +y up; a process of its own
/// reads them (engine/mesh/apart.h), and their vertices have assimp's numbers.
/// Errors: missing, unreadable, cut short or foreign file, or one of more than 1 GiB; a buffer that is missing or not allowed;
/// a glTF that needs an extension; what is compressed and cannot be unpacked;
/// indices that make no whole triangles; no triangle; a vertex that is not finite, or 1e10 m or more away; more than kMostVertices
/// vertices; a scene of more than 100,000 nodes, or as many primitives that share no accessors; a face of more than kMostCorners corners.
Result<Mesh> load_mesh(const std::filesystem::path& file, BufferFiles buffer_files = BufferFiles::below_its_folder);

/// How long an animation takes (s): up to the last of its times.
double duration_of(const Skin::Animation& animation);

/// Where an animation has the joints at `time` (s; before its first and after its last time it holds still): for each the map from the
/// mesh at rest to where the joint takes it, both in the mesh's space. kNone instead of an animation: as the nodes stand in the file.
/// Asserts that check(mesh) finds no fault.
std::vector<Affine> joints_at(const Skin& skin, std::uint32_t animation, double time);

/// Where it has the weights of the morph targets. kNone instead of an animation: what the file says without one.
std::vector<float> weights_at(const Skin& skin, std::uint32_t animation, double time);

/// Applies a transform (scale, then rotation, then translation) to positions, normals and tangents.
void transform_mesh(Mesh& mesh, const Transform& transform);

/// Welds and repairs; what load_mesh does after reading. `render` needs positions and triangles. Normals, tangents and UVs
/// are as many as the positions or none; an entry that is missing, not finite or (normals, tangents) zero is made:
///   normals    smooth over the welded points, so both sides of a seam get the same one
///   UVs        projected onto the two longest axes of the bounding box, the longer one 0 ... 1
///   tangents   from the UVs; any perpendicular where the UVs are degenerate
/// Welding: vertices within weld_tolerance = 1e-6 x the bounding box's diagonal become one point, transitively (a chain of
/// close vertices is one point); which vertices become one depends on positions only, never on the order of triangles.
/// Repaired, with a counted sentence in `mended`: vertices of no triangle (dropped, so render indices shift), triangles with
/// a repeated point or an area below 1e-12 x diagonal^2, duplicate triangles (the first stays), inconsistent winding (the
/// majority of a connected piece wins; normals are then made anew), edges of more than two triangles, pieces that cannot be
/// oriented.
/// Errors: see load_mesh; also lists of unequal length and indices out of range.
Result<Mesh> weld_mesh(RenderMesh render);

/// Whether a mesh that a program made is what Mesh says. Errors: lists of unequal length, no vertex or triangle, an index beyond its
/// list, a point without a render vertex, edges out of order, a position that is not finite or kTooLarge (1e10) m away or more.
Result<void> check(const Mesh& mesh);

/// Gives a mesh room to be split: so many vertices of no triangle, which lie at its first point, behind all others.
void add_spares(Mesh& mesh, std::uint32_t count);

/// Where a mesh is split: these corners of triangles, all of one point, get a point of their own at its place.
struct Split {
  std::uint32_t point = 0;
  std::vector<std::uint32_t> corners;           // 3 triangle + corner, growing
  bool operator==(const Split&) const = default;
};

/// Splits points, one after another, as long as there are spare ones and spare vertices; returns how many. A new point comes last and is like
/// the old one in all that a mesh says of points; render vertices that both sides need are doubled, by the first of the spare ones. Winged
/// edges are those of the triangles as they are then. Errors: a point or corner that is not there, a corner of another point, corners that
/// do not grow, none of the point's corners or all of them; the mesh is then split up to there, with the edges of before.
Result<std::size_t> split_points(Mesh& mesh, std::span<const Split> splits);


/// Winged edges of a triangle list, each pair of points once, so that no constraint is ever doubled. `non_manifold` (may be
/// null) receives the number of edges with more than two triangles or with two of the same orientation. Such an edge keeps
/// its first triangle and the first that runs the other way; the surplus triangles hang on by their points, as if a boundary
/// ran there.
std::vector<WingedEdge> winged_edges(std::span<const Triangle> triangles, std::uint32_t* non_manifold);

/// Unit normals, weighted by the angle at each corner, so that they do not depend on how a face is cut into triangles.
/// A vertex without a triangle of any area gets +y.
/// Source: Thuermer and Wuethrich, "Computing vertex normals from polygonal facets", Journal of Graphics Tools 3(1), 1998.
std::vector<Vec3> smooth_normals(std::span<const Vec3> positions, std::span<const Triangle> triangles);

}  // namespace weft
