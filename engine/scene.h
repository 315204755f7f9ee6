// A scene as its author described it: plain values, SI units, every default stated here and in assets/scene.schema.json.
//
// load_scene reads JSON, refuses what it does not understand (unknown key, wrong type, not-a-number, negative mass ...) with
// the JSON path, the value and the limit, and knows nothing about meshes on disk beyond their path.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compute/result.h"
#include "engine/collider_pose.h"
#include "engine/vector.h"

namespace weft {

/// A pose at a time; pose_at says how poses in between come about.
struct Key {
  double time = 0;           // s, strictly increasing along a list
  Vec3 translate;            // m
  Vec3 axis{0, 1, 0};        // unit
  double degrees = 0;        // about `axis` through the centre of what is moved; more than 360 is allowed and turns that often
  bool operator==(const Key&) const = default;
};

enum class Topology { diagonal, centre };  // one diagonal a cell, all the same way; a vertex in the middle of each cell

struct Grid {
  Vec2 size{1, 1};              // m
  std::uint32_t cells_x = 32;   // 1 ... 2048
  std::uint32_t cells_y = 32;
  Topology topology = Topology::diagonal;
  bool upright = false;         // false: in the xz plane; true: in the xy plane, its top edge along +y
};

struct Transform {
  Vec3 translate;               // m
  Vec3 axis{0, 1, 0};           // unit
  double degrees = 0;
  double scale = 1;             // > 0
};

/// What the cloth is made of; the defaults are cotton's. Stiffnesses are per width of cloth, so they do not change with
/// the resolution.
struct Fabric {
  std::string preset = "cotton";
  double area_density = 0.12;   // kg/m^2
  double stretch = 10e3;        // N/m: tension per width and strain; 0 is not "rigid": infinity is (JSON: "rigid")
  double shear = 45;            // N/m: shear force per width and angle (rad)
  double bend = 1e-5;           // N m: flexural rigidity (Kawabata's B); 0 with `bending: false` only
  double damping = 0.1;         // 1/s: v *= exp(-damping h), in second order v /= 1 + 2/3 damping h
  double friction = 0.4;        // Coulomb, >= 0
  double thickness = 0.002;     // m: separation from colliders
  bool operator==(const Fabric&) const = default;
};

enum class Corner { low_low, high_low, low_high, high_high };  // of a mesh's bounding box in its grid's own axes, x then y

/// Maps: figures of a cloth vary over it, multiplied, vertex by vertex (0 ... 1e6), by an attribute of its mesh, with a channel: vertex
/// colours ("COLOR_0.r"), a custom attribute ("_NAME"), or a painted picture over the UVs, relative to the scene ("stiff.png.g"): a PNG or
/// JPEG whose values count as they stand in the file, 0 ... 1. Without a channel: the first. Empty: 1 everywhere.
struct Maps {
  std::string mass;             // of Fabric::area_density, or Springs::mass; never 0 all around a vertex
  std::string stretch;          // of Fabric::stretch and shear: along a link, as of two springs in series; not with `springs`
  std::string bend;             // of Fabric::bend; not with `springs`
  std::string friction;         // of Fabric::friction
  std::string thickness;        // of Fabric::thickness
  bool operator==(const Maps&) const = default;
};

/// Which vertices an anchor holds, and how they move. Vertices are chosen in the rest pose, after the transform.
struct Anchor {                                  // the union of what vertices, corners, top, box and map choose; never nothing
  std::vector<std::uint32_t> vertices;          // numbers from 0, as the mesh's file has them (Mesh::point_of_source)
  std::vector<Corner> corners;                  // grids only
  std::optional<double> top;                    // every vertex within this distance (m) below the highest
  struct Box { Vec3 low, high; };
  std::optional<Box> box;                       // every vertex inside
  std::string map;                              // every vertex where it (as in Maps) is at least 1/2
  std::uint32_t every = 1;                      // of the chosen, sorted along their longest extent, each n-th and the last
  std::vector<Key> keys;                        // empty: the anchor stays where it was
};

struct Appearance {
  std::string albedo, normal, roughness, occlusion;   // PNG or JPEG paths, relative to the scene; empty: none
  Vec3 base_colour{0.8f, 0.8f, 0.8f};                 // linear, multiplies albedo
  double roughness_factor = 0.8;
  double metallic = 0;
  Vec2 repeat{1, 1};                                  // how often the textures repeat over the mesh's UVs
  bool mesh_materials = false;                        // triangles that have a material in the mesh's file are drawn by that instead
};

/// Springs between neighbours on the mesh, each at rest as long as they are apart there.
struct Springs {
  struct Kind {
    double stiffness = 0;       // N/m; 0: none of this kind
    double damping = 0;         // N s/m, along the spring
  };
  Kind structural;              // edges of the mesh that are no diagonals of quads
  Kind shear;                   // both diagonals of quads
  Kind bend;                    // two of these on. Implicit: all of them, so that a particle inside a grid has 24 neighbours, 5 x 5;
                                // mass_spring: two edges on, straight ahead, 12 neighbours; not with verlet
  double mass = 0;              // kg, of every particle; 0: its share of the fabric's
};

/// How a cloth starts where it does not start at rest; anchors are where they always are.
enum class StartPose {
  rest,
  stretched,     // along its longest side, not at all at one end and by 30 % at the other
  folded,        // about the middle of its longest side, by `degrees`, round an arc of `radius`
  flattened,     // onto a line: its longest side is gone
  scrambled,     // every vertex somewhere in a cube as large as its longest side
  collapsed      // into one point
};
struct Start {
  StartPose pose = StartPose::rest;
  double degrees = 180;         // folded only; 180 lays one half on the other, less leaves it open
  double radius = 0;            // m, folded only; 0: a sharp fold
  Vec3 velocity;                // m/s
  /// Of the fabric's thickness, 0 ... 1: by at most this, and by 1/200 of the mean edge, every free vertex is off its place, across the
  /// cloth, at random, and in every run alike. Without it cloth that is flat to the bit stays flat, since nothing ever pushes it aside.
  double imperfection = 0.02;
  /// 0 ... 2^32 - 1, of what is at random here, the scrambled places and the imperfection: the same seed starts alike in every process.
  /// Where cloth folds is chance; what is said of it should hold with every seed.
  std::uint32_t seed = 1;
};

/// What moves the skin of a cloth's or a mesh collider's file, its morph targets and joints: an animation of it, or the host
/// (Simulation::set_pose, set_morphs, set_targets). A mesh without a skin has a single joint, which carries all of it. A cloth's anchors
/// without keys go where the skin goes; so does all of a collider.
struct Skinning {
  std::string animation;        // its name in the file; empty: the file's first, if there is one
  double speed = 1;             // times as fast as the file has it, >= 0
  double start = 0;             // s: how far it is at the scene's start, >= 0
  bool loops = true;            // begins anew after its end; else it stays as it ends
  bool takes_targets = false;   // whether the host may have a buffer say where it is (Simulation::set_targets)
  bool operator==(const Skinning&) const = default;
};

/// Keeps a cloth's particles near the places to which its skin takes them (its animated pose), and in front of what lies behind these.
///
///        max distance      .  particle            A backstop is a sphere behind the animated place: its nearest point is
///            .     .      /                       `distance` behind it, along the animated normal.
///          .         .   /
///         .     o-----.-'  animated place, with its normal upwards
///     ----.----___----.------ backstop
///
struct MotionConstraints {
  double max_distance = 0.1;    // m, >= 0: no farther from the animated place; 0 holds particles there
  double stiffness = 1;         // 0 ... 1: the part of what is beyond the max distance that an iteration takes back
  double backstop_distance = 0; // m, >= 0
  double backstop_radius = 0;   // m; 0: no backstop
  std::string max_distance_map = {}, stiffness_map = {}, backstop_map = {};   // as in Maps, of max_distance, stiffness, backstop_distance
  bool operator==(const MotionConstraints&) const = default;
};

/// How much a cloth feels of the motion of the frame that it goes with, a character's or a vehicle's: 1 all of it, as in the world; 0
/// nothing, as if the frame stood still.
struct Inertia {
  double linear = 1;            // of its acceleration, 0 ... 1
  double angular = 1;           // of its angular acceleration, and of the Coriolis force, 0 ... 1
  double centrifugal = 1;       // of the centrifugal force, 0 ... 1
  std::string joint;            // of the cloth's skin, by name, that is the frame; empty: the host says (Simulation::move_frame)
  bool operator==(const Inertia&) const = default;
};

/// An ideal gas in a closed cloth, at constant temperature: with p its absolute pressure and V what the cloth encloses,
/// p V = (ambient + rest_pressure) volume (Boyle 1662). The cloth gets p - ambient.
struct Gas {
  double rest_pressure = 1000;  // Pa above the ambient, 0 ... 1e7: of the gas where it has its `volume`
  double ambient = 101325;      // Pa, 0 ... 1e7: of the air outside. The larger, the less the volume gives way
  std::optional<double> volume = {};   // m^3, > 0; none: the mesh's at rest
  bool operator==(const Gas&) const = default;
};

/// Where a cloth tears: across an edge that is stretched by more than `strain`, at one of its ends, which becomes two. What is held never
/// becomes two. Every third frame is looked at, and torn three frames later (engine/README.md, "Tearing").
struct Tear {
  double strain = 0.5;          // > 0: as a fraction of the edge's length at rest
  std::string map = {};         // as in Maps, of the strain; an edge has the mean of its ends
  std::uint32_t spare = 0;      // how many vertices tearing and cutting may add; 0: a quarter of the cloth's
  bool operator==(const Tear&) const = default;
};

/// About which shape a cloth bends: flat, whatever its mesh is, or the mesh's own, with its folds and curves.
enum class BendRest { flat, mesh };

struct Cloth {
  std::string name = "cloth";
  std::optional<Grid> grid;     // either a grid ...
  std::string mesh;             // ... or a file that load_mesh reads, relative to the scene
  std::string render_mesh;      // a finer one that is drawn in its place, a file as `mesh`: it goes where the cloth carries it; empty: none
  Transform transform;          // of both
  Start start;
  Fabric fabric;
  Maps maps;
  bool bending = true;
  bool bends_as_plate = true;            // about flat: where the mesh is a lattice of quads it has a plate's energy in every direction
  BendRest bend_rest = BendRest::flat;   // mesh: methods jacobi, strands and gauss_seidel only
  bool tethers = true;          // takes effect when there are anchors
  std::uint32_t tethers_per_vertex = 4;   // 1 ... 8
  /// How much longer than the geodesic distance tethers are, as a fraction of it, 0 ... 1. None: by direction as much as the fabric
  /// stretches under the cloth's weight, so that it may sag and fold between anchors; not at all where it is rigid or of springs.
  std::optional<double> tether_slack;
  std::optional<Springs> springs;   // methods implicit, mass_spring and verlet only, in place of the fabric's links and bends
  std::vector<Anchor> anchors;
  std::optional<Skinning> skin;
  std::optional<Inertia> inertia;
  std::optional<MotionConstraints> motion_constraints;   // to the rest pose, where nothing moves the skin
  std::optional<Gas> pressure;  // closed meshes only
  std::optional<Tear> tear;     // methods jacobi, strands and gauss_seidel only
  /// Names of the other cloths that it meets by contacts; none: all. Two meet where each has the other, and each meets itself.
  std::optional<std::vector<std::string>> meets = {};
  Appearance appearance;
};

enum class ColliderShape { plane, sphere, capsule, box, mesh };

/// A joint of a cloth's skin, which carries a collider along (Simulation::set_pose, or the file's animation). The collider is described as
/// it is beside the cloth at rest, in world space; its size does not change with the joint's scale.
struct Bone {
  std::string cloth;            // its name; of several the first
  std::string joint;            // its name in the file; empty: the first
  bool operator==(const Bone&) const = default;
};

struct Collider {
  ColliderShape shape = ColliderShape::plane;
  std::string mesh;             // meshes only: a file that load_mesh reads, relative to the scene; its surface is met from both sides
  double scale = 1;             // meshes only, > 0
  double thickness = 0.002;     // m, meshes only: the separation is the mean of it and the fabric's
  Vec3 centre;                  // m; a point of the plane, where a mesh's origin lies, or the middle of the others
  Vec3 normal{0, 1, 0};         // unit, planes only
  double radius = 0.5;          // m, spheres and capsules
  /// m, capsules only: the radius at the end to which `axis` points, where that is another: the capsule is the convex hull of its two ends'
  /// spheres. None: `radius`.
  std::optional<double> radius_end = {};
  double length = 0.5;          // m, capsules only: from the centre of one end's sphere to the other's
  Vec3 size{1, 1, 1};           // m, boxes only: whole sides
  Vec3 axis{0, 1, 0};           // unit: along which a capsule lies, or about which a box or a mesh is turned
  double degrees = 0;           // boxes and meshes only: how far
  double friction = 0.4;        // combined with the fabric's by the geometric mean
  std::optional<Skinning> skin; // meshes only
  std::optional<Bone> bone;     // not with keys; not of meshes, which have skins
  /// Names of the cloths that it meets, all of such a name; none: all.
  std::optional<std::vector<std::string>> meets;
  bool resizes = false;         // whether the host may resize it (Simulation::resize_collider); neither planes nor meshes
  std::vector<Key> keys;
  Vec3 colour{0.5f, 0.5f, 0.5f};
};

/// How a substep is solved; engine/README.md tells them apart.
/// `automatic`, in JSON "auto", is replaced by what SolverSettings::budget_ms buys when a simulation is created (reference/choice.h).
enum class Method { by_default, jacobi, strands, gauss_seidel, chebyshev, mass_spring, verlet, implicit, automatic };

/// How the method implicit solves its equations: conjugate gradients, or damped block Jacobi, both preconditioned by 3x3 blocks.
enum class Linear { cg, jacobi };

enum class Averaging { mass_split, count };  // momentum-conserving (Tonge 2012); Flamenco's, for comparison

struct SolverSettings {
  double rate = 60;             // Hz: frames a second; a substep lasts 1 / (rate substeps)
  std::uint32_t substeps = 0;   // 0: the default (engine/reference/README.md says why)
  std::uint32_t iterations = 1; // 1 ... 1000
  std::uint32_t bend_steps = 1; // 1 ... 4: towards how the fabric bends, in one dispatch; no more than are needed. One iteration only
  Method method = Method::by_default;   // method_of says which
  std::optional<double> budget_ms = {};   // of a frame; method automatic only
  Linear linear = Linear::cg;   // method implicit only
  Averaging averaging = Averaging::mass_split;
  double relaxation = 0;        // over-relaxation omega, below most_relaxation; 0: relaxation_of
  double rho = 0;               // Chebyshev only: the spectral radius it takes Jacobi's iteration to have, below 1; 0: rho_of
  std::uint32_t order = 1;      // 1 or 2: of the error in time, by implicit Euler or by BDF2 (shaders/bdf2/bdf2.glsl)
  std::optional<bool> levels = {};   // coarse levels before each iteration, or in the preconditioner of implicit; not set: levels_of
  bool shifts = false;          // links ask for what sweeps before left them short of (shaders/shift/shift.glsl)
  double longest_advance = 0.1; // s: a longer advance() is clamped to this, and the surplus reported
};

/// The largest capacity for candidate pairs, 52 bytes each: what a device with a few GiB has for them. Others refuse less in create.
inline constexpr std::uint32_t kMostCandidates = 1u << 26;

/// Cloth against cloth, itself included, and against mesh colliders. contacts_on says whether a scene has them.
struct Contacts {
  std::optional<bool> enabled;  // nothing: on, wherever the solver goes with contacts
  double recover = 0.25;        // m/s, >= 0: how fast a pair closer than its separation is pushed apart, and how fast an anchor that
                                // cloth held back catches up with its target
  std::uint32_t capacity = 0;   // candidate pairs at the start; 0: chosen. It grows before more is needed
  double cell = 0;              // m, cell of the spatial hash; 0: chosen
  double detection_margin = 0;  // m, how far a particle may stray from its predicted trajectory before the next detection; 0: chosen
  std::uint32_t iterations = 4; // 1 ... 100: of contacts, in each of the solver's iterations
  double kinematic_lag_limit = 8;   // times the larger thickness of the two, >= 0: how far behind its target cloth may hold an
                                    // anchor or a mesh collider, besides a substep's motion, before it is driven through
  bool untangle = true;         // cloth that goes through cloth, or through a mesh collider, is taken back over the next frames
  bool operator==(const Contacts&) const = default;
};

/// Scene::pins and Scene::grabs at most.
inline constexpr std::uint32_t kMostPins = 4096, kMostGrabs = 16;

/// m/s. No component of a wind may be faster.
inline constexpr float kFastestWind = 1e3f;

/// The air that cloth moves in: a wind, and what comes and goes on top of it. Coefficients are those of a flat plate, relative to the
/// dynamic pressure and the area: with these defaults the pressure acts along the normal, and the rest is the skin's friction.
struct Air {
  struct Gust {
    Vec3 velocity;              // m/s, at its strongest: it swings between this and its opposite, as a sine
    double period = 1;          // s, > 0
    double phase = 0;           // degrees: where in its swing it is at the start
  };
  /// What the air does in a part of space, besides.
  struct Field {
    enum class Shape { box, sphere, jet, vortex };
    Shape shape = Shape::box;
    Vec3 centre;                // m: of a box or a sphere; of a jet's nozzle; a point of a vortex's axis
    Vec3 velocity;              // m/s: within a box or a sphere; of a jet in its nozzle, and where it goes. Of a vortex the axis, about which it
                                // turns by the right hand, as long as it is fast where it is fastest
    Vec3 size{1, 1, 1};         // m, boxes only: whole sides, > 0
    double radius = 0.5;        // m, > 0: of a sphere, a jet's nozzle, or the core of a vortex, where it is fastest
    double falloff = 0.5;       // m, boxes and spheres only: how far outside the velocity has faded away
    bool operator==(const Field&) const = default;
  };
  double density = 1.2;         // kg/m^3, at 20 degrees C at sea level
  double drag = 1.17;           // broadside on, along the wind (a square plate: Hoerner 1965, 3-16)
  double lift = 1.15;           // across the wind, times the sine and the cosine of the angle between plate and wind
  double friction = 0.02;       // edge on, along the wind
  Vec3 wind;                    // m/s; the host may change it (Simulation::set_wind)
  std::vector<Gust> gusts;      // at most 8
  std::vector<Field> fields;    // at most 16; the host may move them (Simulation::move_air_field)
  bool lee = false;             // whether air is slower behind colliders, but planes, and cloths, in the wake that the wind has there
  double turbulence = 0;        // m/s, root mean square; free of divergence, carried along by the wind
  double eddy = 1;              // m, > 0: the length of the largest eddies; the smallest are an eighth of it
};

struct Camera {
  Vec3 eye{0, 1, 4}, target{0, 0.5f, 0};   // m
  double fov_degrees = 40;      // vertical
};

struct Light {
  Vec3 direction{-0.4f, -1, -0.6f};   // the way the sun's light goes; any length but 0
  Vec3 colour{1, 0.96f, 0.9f};
  double sun = 4;               // intensities, relative to a white sky of 1
  double sky = 1;
};

/// Which files a glTF may name as its buffers and images. Not a key: who reads a scene decides, and not who wrote it.
enum class BufferFiles { below_its_folder, anywhere };

struct Scene {
  std::string name;
  std::string description;            // what it shows, for people
  std::filesystem::path folder;       // paths in the scene are relative to this
  BufferFiles buffer_files = BufferFiles::below_its_folder;   // of its meshes; in no scene file
  std::uint32_t frames = 300;
  Vec3 gravity{0, -9.81f, 0};         // m/s^2
  SolverSettings solver;
  Contacts contacts;
  std::optional<Air> air;             // none: cloth meets no resistance but its own damping
  std::uint32_t pins = 0;             // vertices that the host may pin at a time, besides anchors (Simulation::pin); 0: none, nor release any
  std::uint32_t grabs = 0;            // places of cloth that the host may pull at a time (Simulation::grab)
  bool reactions = false;             // adds up what cloth does to colliders and to grabs (take_reactions, take_pulls)
  std::vector<Cloth> cloths;          // 1 ... 1024
  std::vector<Collider> colliders;    // at most 1024; each costs every particle
  Camera camera;
  Light light;
};

/// A `--set path.to.value=X` assignment: the path's parts are keys or list indices; X is JSON, or else taken as text.
struct Assignment {
  std::string path, value;
};

/// Reads and checks a scene file of at most 64 MiB, nested at most 64 deep. Errors: a file that is missing, not regular, too large or
/// cannot be read; what parse_scene names.
Result<Scene> load_scene(const std::filesystem::path& file, std::span<const Assignment> assignments = {});

/// The same from text; `folder` is what relative paths start from. Errors: text that is not JSON or nests too deep, with line and column; a
/// key twice; an assignment whose path leads nowhere; an unknown key, a wrong type, a value outside its limits, a file that is not there,
/// and rules between keys. Every fault that is found is named, one sentence a line, each with its JSON path.
Result<Scene> parse_scene(std::string_view text, const std::filesystem::path& folder, std::span<const Assignment> assignments = {});

/// What a scene file is checked for, of a scene that a program made: every number within its limits and finite, every list within its
/// length, every choice one of those there are, and the rules between keys. Files are not looked for. Errors: each of these, one sentence a
/// line with its JSON path.
Result<void> check(const Scene& scene);

/// A scene as JSON, every key written out: parse_scene with the same folder reads it back to the same scene.
std::string scene_text(const Scene& scene);

/// The scene a bare mesh gets: pinned along its top, a floor below, a camera that sees all of it.
Scene default_scene(const std::filesystem::path& mesh, Vec3 low, Vec3 high);

/// Silk, cotton, denim, leather with their figures; nothing for another name. Sources stand beside the table.
std::optional<Fabric> fabric_preset(std::string_view name);

/// Whether contacts are on: as the scene says, or where it has a mesh collider; where it says nothing, unless its solver does not go with
/// them (the method chebyshev, second order).
bool contacts_on(const Scene& scene);

/// Methods that solve springs, the scene's or those that the fabric makes, instead of constraints.
constexpr bool on_springs(Method method) { return method == Method::implicit || method == Method::mass_spring || method == Method::verlet; }

/// Over-relaxation from here on can blow a scene up: 1 + 3^(-1/iterations), 4/3 with one iteration a substep; in second order 1 +
/// (9/55)^(1/iterations); with Chebyshev 1 + rho.
/// engine/scene/method.cpp says why.
double most_relaxation(const SolverSettings& solver);

/// What the solver's relaxation is, with defaults filled in.
double relaxation_of(const Scene& scene);

/// The method that solves the scene: by default, where the scene has coarse levels, gauss_seidel, with contacts strands; jacobi elsewhere and
/// in second order.
Method method_of(const Scene& scene);

/// Whether tethers hold every cloth to anchors that no keys move.
bool tethers_hold(const Scene& scene);

/// Whether it has coarse levels. Methods jacobi, strands and gauss_seidel may, and implicit with linear cg; unless told otherwise strands
/// does, and the default unless tethers_hold.
bool levels_of(const Scene& scene);

/// Whether the scene has what moves whatever cloth does, and may push cloth along: anchors with keys, skins, mesh colliders, or pins.
bool is_driven(const Scene& scene);

/// The spectral radius that Chebyshev's iteration takes Jacobi's to have, with its default filled in.
double rho_of(const SolverSettings& solver);

/// Why the scene's relaxation is refused, as what follows "solver.relaxation: "; empty if it is not.
std::string relaxation_fault(const Scene& scene);

/// Why a scene of second order in time is refused, as what follows "solver.order: "; empty if it is not.
std::string order_fault(const Scene& scene);

/// Why the scene's method cannot solve it, as what follows "solver.method: "; empty if it can.
std::string method_fault(const Scene& scene);

/// The radius of a capsule's end, which is `radius` where none is given.
inline double radius_at_end(const Collider& collider) { return collider.radius_end.value_or(collider.radius); }
inline ColliderSize size_of(const Collider& collider) { return {collider.radius, radius_at_end(collider), collider.length, collider.size}; }

/// Whether a cloth and a collider meet, or two cloths by contacts (meets).
bool meet(const Cloth& cloth, const Collider& collider);
bool meet(const Cloth& a, const Cloth& b);

/// Indices of the colliders that are meshes. They are part of what is simulated; the others are formulas.
std::vector<std::uint32_t> mesh_colliders(const Scene& scene);

/// The rotation of a collider before its keys rotate it: takes +y to a capsule's axis and the world's axes to a box's or a mesh's.
Rotation rest_rotation(const Collider& collider);

/// The rotation by `degrees` about `axis` (unit).
Rotation rotation_about(Vec3 axis, double degrees);

/// First b, then a.
Rotation operator*(const Rotation& a, const Rotation& b);
Vec3 rotated(const Rotation& rotation, Vec3 v);

/// Where a key list puts things at `time`: before the first and after the last it holds still. In between, translations
/// are interpolated linearly; angles too where both keys turn about one axis (720 degrees turn twice), and along the
/// shortest arc where the axes differ. No keys: no motion.
Key pose_at(std::span<const Key> keys, double time);

}  // namespace weft
