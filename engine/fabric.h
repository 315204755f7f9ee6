// Cooking: from meshes and a scene to arrays in the layout the GPU reads (shaders/shared.h). Pure functions, no Vulkan.
//
// Particles are ordered for locality (reverse Cuthill-McKee), cloth after cloth, so that neighbours in the cloth are
// neighbours in memory. Everything is computed in double precision and stored once.
#pragma once

#include <any>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <typeindex>
#include <vector>

#include "compute/result.h"
#include "engine/mesh.h"
#include "engine/scene.h"
#include "shaders/shared.h"

namespace weft {

/// A distance constraint between two particles: an edge of the mesh, or the other diagonal of a quad (`only_pulls`).
struct StretchLink {
  std::uint32_t a, b;
  float rest;        // m, as the GPU has it
  float compliance;  // m/N, the fabric's
  bool only_pulls;
  float gain = 0;    // kg: 1 / (W_a + W_b + omega compliance / h^2) as the GPU has it, with one Jacobi iteration a substep; 0 if both ends
                     // are kinematic
  bool in_strand = false;   // solved with its strand and not by Jacobi
  float part = 1;    // of its stiffness that it has itself: coarse levels have the rest
  float own_compliance() const { return compliance / part; }
};

/// A spring of the methods on springs, once a pair: a link with its stiffness, a spring of Cloth::springs, or, linear with rest 0 and of
/// either sign, an entry of the bending matrix.
struct ParticleSpring {
  std::uint32_t a, b;
  float rest;        // m
  float stiffness;   // N/m
  float damping;     // N s/m
  bool only_pulls;
};

/// The springs as the GPU reads them: a particle's other ends, four a fetch, and beside each its figures (shared.h, `springs`).
struct SpringRows {
  std::vector<gpu::uvec2> rows;     // per particle: first four, number of fours
  std::vector<gpu::uvec4> ends;     // an unused entry holds the particle itself
  std::vector<gpu::vec4> springs;   // four for each of `ends`
};

/// A cloth's place in the arrays.
struct ClothRange {
  std::string name;
  std::uint32_t first_particle, particles;   // with those that are spare, at its end: inverse mass 0, and no constraints
  std::uint32_t first_vertex, vertices;   // render vertices
  std::uint32_t first_anchor, anchors;
};

/// A mesh collider's place in the arrays: after all cloths. Its particles are kinematic (inverse mass 0) and have no constraints.
struct ColliderMesh {
  std::uint32_t collider;                 // Scene::colliders[collider]
  std::uint32_t first_particle, particles;
  std::uint32_t first_vertex, vertices;   // render vertices
  std::uint32_t first_triangle, triangles;
};

/// A render mesh's place in the arrays: after all mesh colliders.
struct CarriedMesh {
  std::uint32_t cloth;                    // that carries it
  std::uint32_t first_vertex, vertices;   // render vertices
};

/// An anchor: a kinematic particle of cloth.
struct AnchorTarget {
  std::uint32_t cloth, entry;   // Scene::cloths[cloth].anchors[entry]
  std::uint32_t particle;
  std::uint32_t vertex;         // a render vertex of the mesh that belongs to it
  Vec3 rest;                    // m, where it is without keys
};

/// Rows of a sparse list, two entries a 16-byte fetch: rows[i] = (first pair, number of entries).
struct PairRows {
  std::vector<gpu::uvec2> rows;    // per particle
  std::vector<gpu::uvec4> pairs;
  std::uint32_t stride = 0;        // pairs in every row, where they are padded to one length; 0: rows tell
};

/// What effects cook for themselves alone: a struct of each, in its own room, told apart by its type.
class OwnLists {
 public:
  template <class T>
  T& of() {
    std::any& held = lists_[typeid(T)];
    if (!held.has_value()) held.emplace<T>();
    return *std::any_cast<T>(&held);
  }
  /// An empty one where nothing was cooked.
  template <class T>
  const T& of() const {
    static const T none{};
    const auto at = lists_.find(typeid(T));
    return at == lists_.end() ? none : *std::any_cast<T>(&at->second);
  }

 private:
  std::map<std::type_index, std::any> lists_;
};

struct CookedFabric {
  std::vector<ClothRange> cloths;
  std::vector<ColliderMesh> collider_meshes;
  std::vector<CarriedMesh> render_meshes;
  std::vector<gpu::vec4> positions;          // particles: xyz (m), w inverse mass (1/kg), 0 for anchors
  std::vector<gpu::vec4> velocities;         // particles: xyz (m/s), w the material's index as bits
  std::vector<float> inverse_masses;         // particles: 1/kg, of those that are held, too; only where a scene may pin, colliders' 0
  std::vector<float> split_weights;          // particles: n w (mass split) or w (count), see stretch.comp
  std::vector<float> iterate_weights;        // particles: weight of the sum over a particle's links, see stretch.comp
  std::vector<StretchLink> links;
  PairRows stretch;                          // entries: gpu::pack_link with the gain, or the compliance with several iterations
  std::vector<gpu::Bend> bends;
  PairRows bend;                             // entries: (particle, coefficient bits); one iteration a substep only
  PairRows bend_uses;                        // entries: (bend, K w bits); several iterations only
  std::vector<gpu::Hinge> hinges;            // of cloths that bend about their meshes; these have no `bends`
  std::vector<ParticleSpring> springs;       // methods on springs only
  double largest_step = 0;                   // s: a longer substep of mass_spring or verlet could blow up
  SpringRows spring_rows;
  double jacobi_weight = 0;                  // of the damped Jacobi that solves for them: engine/reference/implicit.h
  std::vector<gpu::Tether> tethers;          // particles x tethers_per_particle, an even number
  std::uint32_t tethers_per_particle = 0;
  std::uint64_t tether_count = 0;            // without the unused places
  std::vector<AnchorTarget> anchors;
  std::vector<gpu::Material> materials;      // per cloth, then per mesh collider; one of each kind of vertex where maps vary a cloth's
  std::vector<gpu::uvec4> surface_rows;      // per render vertex: of cloths, then of mesh colliders
  std::vector<gpu::uvec2> corners;
  std::vector<Triangle> triangles;           // over particles: of cloths, then of mesh colliders
  std::uint32_t cloth_triangles = 0;         // how many of them are cloth
  std::vector<gpu::uvec2> edges;             // over particles: of all triangles, each once; lower particle first
  std::vector<gpu::vec4> rest;               // particles: xyz rest position (m), a mesh collider's in its own axes, w thickness (m); only
                                             // with contacts
  double mean_edge = 0;                      // m, over the edges of cloth; only with contacts
  OwnLists own;                              // of effects whose lists nobody else reads
  double h = 0;                              // s, the substep that coefficients were cooked for
  std::vector<std::string> notes;            // one sentence a kind of thing that was repaired, left out or clamped
};

/// Substeps a frame, with the default filled in.
std::uint32_t substeps_of(const SolverSettings& solver);

/// s, over which forces and constraints of a substep act: all of it, or in second order two thirds (shaders/bdf2/bdf2.glsl).
inline double solve_step(const Scene& scene, const CookedFabric& fabric) { return scene.solver.order == 2 ? 2 * fabric.h / 3 : fabric.h; }

/// Loads or generates every cloth's mesh and puts it where its transform says; after these, in the order of the scene, the meshes of
/// its mesh colliders, scaled, in their own axes, and then the render meshes that cloths carry, in the order of these. Errors, which name
/// the cloth or the collider: a grid and a mesh, or neither; a grid of no size or too many cells; what load_mesh refuses; more vertices
/// than can be simulated.
Result<std::vector<Mesh>> make_meshes(const Scene& scene);

/// Errors: no particle, more than WEFT_MAX_PARTICLES, an anchor that chooses nothing or a vertex the mesh does not have,
/// mass or a coefficient that is not finite. `meshes` has one entry a cloth, one a mesh collider and one a render mesh, as make_meshes
/// gives them.
Result<CookedFabric> cook(const Scene& scene, std::span<const Mesh> meshes);

/// The cloth that `fabric` was cooked as, torn: its meshes with more of their points split. Particles keep their numbers, anchors are those
/// of before, and new points take the places that were spare. Lists may have other lengths. Errors: as cook.
Result<CookedFabric> torn_anew(const Scene& scene, std::span<const Mesh> meshes, const CookedFabric& fabric);

/// The same cloth with other particles held, an entry each: all lists that depend on who is held, of the lengths that they had. Only of
/// scenes with `pins`. `meshes`: of which it was cooked.
CookedFabric held_anew(const Scene& scene, std::span<const Mesh> meshes, const CookedFabric& fabric, const std::vector<bool>& held);

/// Where every anchor should be at a time, in CookedFabric::anchors' order, by the scene's keys.
std::vector<Vec3> anchor_targets(const Scene& scene, const CookedFabric& fabric, double time);

/// Where a mesh collider's particles are, in their order, when the collider stands so.
std::vector<Vec3> collider_points(const CookedFabric& fabric, const ColliderMesh& mesh, Vec3 centre, const Rotation& rotation);

/// Where one of them is, the `k`-th of its own, when the collider stands so.
Vec3 collider_point(const CookedFabric& fabric, const ColliderMesh& mesh, std::uint32_t k, Vec3 centre, const Rotation& rotation);

/// The body to which a particle belongs: its cloth, or cloths + mesh collider.
std::uint32_t body_of(const CookedFabric& fabric, std::uint32_t particle);

/// Of each cloth, the mean length at rest of the links that push, too, and may move (m); 0 where it has none.
std::vector<float> mean_links(const CookedFabric& fabric);

/// The number of kinematic particles: all anchors, then those of mesh colliders.
std::uint32_t kinematic_particles(const CookedFabric& fabric);

/// The indices of cloths that carry a render mesh.
std::vector<std::uint32_t> render_meshes(const Scene& scene);

/// The pictures that a cloth's maps name, with their keys.
std::vector<std::pair<std::string, std::string>> painted_maps(const Cloth& cloth);

/// All render vertices: of cloths, of mesh colliders and of render meshes.
std::uint32_t drawn_vertices(const CookedFabric& fabric);

/// Particles and render vertices of cloth: those of mesh colliders come after them.
std::uint32_t cloth_particles(const CookedFabric& fabric);
std::uint32_t cloth_vertices(const CookedFabric& fabric);

}  // namespace weft
