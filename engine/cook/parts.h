// Declarations that the sources of cooking share; not part of the public API.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/fabric.h"

namespace weft::cooking {

// A larger compliance (m/N) has no visible effect, and divided by h^2 it would not stay finite: infinity times a multiplier
// of zero is NaN, which spreads to the particle's other links.
inline constexpr double kSoftest = 1e12;

// Of angles at a vertex: a larger one belongs to an angle below 3 degrees, and such slivers would make their neighbours rigid.
inline constexpr double kLargestCotangent = 20;

inline Eigen::Vector3d vector(Vec3 v) { return {v.x, v.y, v.z}; }

/// What a map says of each point (Maps); empty without a map. Errors: an attribute that the mesh does not have, another channel, a value
/// that is less than 0 or more than 1e6.
Result<std::vector<float>> mapped(const std::string& key, const std::string& map, const Mesh& mesh);

/// The factors by which a cloth's figures vary, of each point; empty: 1 everywhere.
struct Factors {
  std::vector<float> mass, stretch, bend, friction, thickness;
};
inline double factor(const std::vector<float>& factors, std::size_t point) { return factors.empty() ? 1.0 : double(factors[point]); }
/// Between two points: side by side, as of a fold along them; and one after the other, as of a link, which gives way as springs in series
/// do.
inline double factor(const std::vector<float>& factors, std::size_t a, std::size_t b) {
  return 0.5 * (factor(factors, a) + factor(factors, b));
}
inline double in_series(const std::vector<float>& factors, std::size_t a, std::size_t b) {
  const double first = factor(factors, a), second = factor(factors, b);
  return first > 0 && second > 0 ? 2 / (1 / first + 1 / second) : 0;
}
Result<Factors> factors_of(const Maps& maps, const Mesh& mesh);

/// Adds the pictures that a cloth's maps name, in `folder`, to the mesh's attributes, under their paths. Errors: what read_image refuses.
Result<void> add_pictures(const std::filesystem::path& folder, const weft::Cloth& cloth, Mesh& mesh);

/// order[k] is the point that becomes the cloth's k-th particle: reverse Cuthill-McKee (1969) over the mesh's edges.
std::vector<std::uint32_t> locality_order(const Mesh& mesh);

/// Of a cloth that is cooked: the particle of each point.
std::vector<std::uint32_t> particles_of(const CookedFabric& fabric, const ClothRange& cloth, const Mesh& mesh);

/// A link between two points, with the stiffness of the strip of cloth that it represents.
struct Spring {
  std::uint32_t a, b;      // points
  double rest;             // m
  double compliance;       // m/N
  bool only_pulls;
  enum class Kind { edge, diagonal, far } kind = Kind::edge;   // diagonal: either one of a quad
};

struct Stiffness {
  double stretch, shear;   // N/m; infinity is rigid
};

/// The direction of the warp (growing u) in a triangle's plane; zero where the UVs say nothing.
Eigen::Vector3d warp(const Mesh& mesh, std::uint32_t triangle);

/// Edges of the mesh, the second diagonal of every quad, and, if `far`, far links along straight lines of edges. Stiffness by
/// direction: see engine/effects/stretch/links.cpp.
std::vector<Spring> springs(const Mesh& mesh, const Stiffness& stiffness, bool far = true);

/// Appends to `near` links that only pull, between points `steps` edges apart on a straight line of edges: see
/// engine/effects/stretch/far_links.cpp. Up to half of the stiffness of those edges (the first of `near`, in the mesh's
/// order) moves over to them. Edges that are `is_diagonal` belong to no line.
void add_far_links(const Mesh& mesh, const std::vector<bool>& is_diagonal, std::uint32_t steps, std::vector<Spring>& near);

/// A spring of Cloth::springs, which pushes and pulls.
struct NeighbourSpring {
  std::uint32_t a, b;      // points
  double rest;             // m
  Springs::Kind kind;
};

/// Between all points that are one or two links of the mesh apart, or, `straight`, one link or two edges straight ahead: see
/// engine/effects/spring/springs.cpp.
std::vector<NeighbourSpring> neighbour_springs(const Mesh& mesh, const weft::Springs& springs, bool straight);

/// The longest step of symplectic Euler that is stable in every pose (s); infinite where nothing moves: see
/// engine/effects/spring/longest_step.cpp.
double largest_step(std::span<const ParticleSpring> springs, std::span<const gpu::vec4> positions);

/// The bending matrix of stencils over particles, as linear springs.
void add_bending_springs(std::span<const gpu::Bend> bends, std::vector<ParticleSpring>& springs);

SpringRows spring_rows(std::span<const ParticleSpring> springs, std::size_t particles);

/// The weight of damped Jacobi, with which it converges in every pose.
double jacobi_weight(std::span<const ParticleSpring> springs);

/// Bending stencils over points; split_weight is left at 0. `clamped` counts slivers whose cotangents were limited.
std::vector<gpu::Bend> bend_stencils(const Mesh& mesh, double rigidity, bool as_plate, std::uint32_t& clamped);
/// Adds those of the parts of a mesh that are a lattice of quads: see engine/effects/bend/lattice.cpp. Returns whether a triangle is in one.
std::vector<bool> add_lattice_stencils(const Mesh& mesh, double rigidity, std::vector<gpu::Bend>& bends);

/// Dihedral elements of a cloth that bends about its mesh's angles, over the particles of its points; lay_out_hinges adds
/// masses and uses. Returns the number of elements softened because they lie on slivers. See
/// engine/effects/dihedral/hinges.cpp.
std::uint32_t add_hinges(const Mesh& mesh, std::span<const std::uint32_t> particle_of, double rigidity, const std::vector<float>& factors,
                         CookedFabric& fabric);
void lay_out_hinges(Averaging averaging, bool may_pin, CookedFabric& fabric);

/// The nearest `count` of `anchors` (points) to every point with their geodesic distances, nearest first; fewer where fewer
/// are connected. See engine/effects/tether/geodesic.cpp.
struct AnchorDistance {
  std::uint32_t anchor;    // index into `anchors`
  double distance;         // m
  double askew;            // cos^2 sin^2 of the angle between the way, where it arrives, and the warp: 0 along threads and without UVs
};
std::vector<std::vector<AnchorDistance>> nearest_anchors(const Mesh& mesh, std::span<const std::uint32_t> anchors, std::uint32_t count);

/// The points that each of the cloth's anchor entries chooses. Errors name the entry.
struct AnchorChoice {
  std::uint32_t entry, point, vertex;
};
Result<std::vector<AnchorChoice>> choose_anchors(const weft::Cloth& cloth, const Mesh& mesh);

/// Rest positions of the cloth's particles; add_collider_mesh appends those of mesh colliders.
void add_rest(CookedFabric& fabric);

/// Sets a cloth's positions and velocities to those of its `start`: see engine/cook/start.cpp. Comes last: all else is cooked
/// at rest.
void take_start(const weft::Cloth& cloth, const ClothRange& range, CookedFabric& fabric);

/// Appends a mesh collider in its pose at time 0, by the scene's keys. Errors: too many particles.
Result<void> add_collider_mesh(const Scene& scene, std::uint32_t collider, const Mesh& mesh, CookedFabric& fabric);

/// Adds all edges of all triangles, and the mean length of those of cloth.
void add_edges(CookedFabric& fabric);

enum class Padding { owner, repeated };

/// Lists of (id, payload) entries, packed two a fetch. An unused place has payload 0 and, as its id, the list's own number
/// (owner) or the last id (repeated). Where that adds no more than the fraction `most_padding`, all rows are padded to one
/// length with such places of the list's own number; 0: never.
PairRows pack_rows(std::span<const std::vector<gpu::uvec2>> lists, Padding padding, double most_padding = 0);

}  // namespace weft::cooking
