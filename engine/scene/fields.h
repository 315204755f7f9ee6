// Every key that a scene file may hold, with its limits: one table an object, written as a function over a visitor.
//
// The reader (engine/scene/reader.cpp) walks these tables to fill a Scene; the schema test walks them to compare assets/scene.schema.json
// key by key. A key that is not here does not exist. Internal: not part of the public API.
//
// A visitor has these members, each called with the key and the value it stands for:
//   text, flag, number, optional_number, stiffness (a number or "rigid"), whole, choice, choices, vector2, vector3, direction,
//   unit (normalised), colour, file, cells, whole_list, object, optional_object, list, fabric, tethers, contacts, note (read by
//   nobody)
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "engine/scene.h"

namespace weft::scene_fields {

/// What a number may be. `unit` is only for people.
struct Range {
  double low, high;
  bool above = false;  // low itself is excluded
  bool below = false;  // high itself is excluded
  std::string_view unit = "";
};

constexpr Range between(double low, double high, std::string_view unit = "") { return {low, high, false, false, unit}; }
constexpr Range above(double low, double high, std::string_view unit = "") { return {low, high, true, false, unit}; }
constexpr Range below(double low, double high, std::string_view unit = "") { return {low, high, false, true, unit}; }
constexpr Range inside(double low, double high, std::string_view unit = "") { return {low, high, true, true, unit}; }

// Further than this from the origin a float cannot tell millimetres apart by a hundred kilometres; nobody's cloth is there.
constexpr double kFarthest = 1e5;  // m
constexpr Range kPlace = between(-kFarthest, kFarthest, "m");
constexpr Range kTurn = between(-1e6, 1e6, "degrees");
// Stiffer than 1e9 N/m is beyond what float positions resolve; "rigid" says it better.
constexpr Range kStiffness = above(0, 1e9, "N/m");
constexpr Range kFriction = between(0, 10);

constexpr std::size_t kMostCloths = 64;
constexpr std::size_t kMostColliders = 64;
constexpr std::size_t kMostAnchors = 1024;
constexpr std::size_t kMostKeys = 100'000;
constexpr std::size_t kMostVertices = 4'000'000;  // as many as a mesh may have

using Names = std::span<const std::string_view>;
inline constexpr std::array<std::string_view, 2> kTopologies = {"diagonal", "centre"};
inline constexpr std::array<std::string_view, 4> kCorners = {"low_low", "high_low", "low_high", "high_high"};
inline constexpr std::array<std::string_view, 6> kStartPoses = {"rest", "stretched", "folded", "flattened", "scrambled", "collapsed"};
inline constexpr std::array<std::string_view, 2> kBendRests = {"flat", "mesh"};
inline constexpr std::array<std::string_view, 5> kShapes = {"plane", "sphere", "capsule", "box", "mesh"};
inline constexpr std::array<std::string_view, 7> kMethods = {"jacobi", "gauss_seidel", "chebyshev", "mass_spring", "verlet", "implicit", "auto"};
inline constexpr std::array<std::string_view, 2> kLinears = {"cg", "jacobi"};
inline constexpr std::array<std::string_view, 2> kAveragings = {"mass_split", "count"};
inline constexpr std::array<std::string_view, 3> kMeshEndings = {".gltf", ".glb", ".obj"};
inline constexpr std::array<std::string_view, 3> kPictureEndings = {".png", ".jpg", ".jpeg"};

/// The object form of `tethers`, flat in Cloth.
struct Tethers {
  std::uint32_t per_vertex = Cloth{}.tethers_per_vertex;
  double slack = Cloth{}.tether_slack;
};

template <class V>
void fields(V& v, Key& key) {
  v.number("time", key.time, between(0, 1e6, "s"));
  v.vector3("translate", key.translate, kPlace);
  v.unit("axis", key.axis);
  v.number("degrees", key.degrees, kTurn);
}

template <class V>
void fields(V& v, Grid& grid) {
  v.vector2("size", grid.size, above(0, kFarthest, "m"));
  v.cells("cells", grid.cells_x, grid.cells_y, between(1, 2048));
  v.choice("topology", grid.topology, kTopologies);
  v.flag("upright", grid.upright);
}

template <class V>
void fields(V& v, Transform& transform) {
  v.vector3("translate", transform.translate, kPlace);
  v.unit("axis", transform.axis);
  v.number("degrees", transform.degrees, kTurn);
  v.number("scale", transform.scale, above(0, 1e6));
}

template <class V>
void fields(V& v, Start& start) {
  v.choice("pose", start.pose, kStartPoses);
  v.number("degrees", start.degrees, kTurn);
  v.number("radius", start.radius, between(0, kFarthest, "m"));
  v.vector3("velocity", start.velocity, between(-1e3, 1e3, "m/s"));
}

template <class V>
void fields(V& v, Fabric& fabric) {
  v.text("preset", fabric.preset);
  v.number("area_density", fabric.area_density, above(0, 1e3, "kg/m^2"));
  v.stiffness("stretch", fabric.stretch, kStiffness);
  v.stiffness("shear", fabric.shear, kStiffness);
  v.number("bend", fabric.bend, between(0, 1e6, "N m"));
  v.number("damping", fabric.damping, between(0, 1e3, "1/s"));
  v.number("friction", fabric.friction, kFriction);
  v.number("thickness", fabric.thickness, between(0, 1, "m"));
}

template <class V>
void fields(V& v, Tethers& tethers) {
  v.whole("per_vertex", tethers.per_vertex, between(1, 8));
  v.number("slack", tethers.slack, between(0, 1));
}

template <class V>
void fields(V& v, Anchor::Box& box) {
  v.vector3("low", box.low, kPlace);
  v.vector3("high", box.high, kPlace);
}

template <class V>
void fields(V& v, Anchor& anchor) {
  v.whole_list("vertices", anchor.vertices, between(0, kMostVertices - 1), kMostVertices);
  v.choices("corners", anchor.corners, kCorners);
  v.optional_number("top", anchor.top, between(0, kFarthest, "m"));
  v.optional_object("box", anchor.box);
  v.whole("every", anchor.every, between(1, kMostVertices));
  v.list("keys", anchor.keys, 0, kMostKeys);
}

template <class V>
void fields(V& v, Appearance& appearance) {
  v.file("albedo", appearance.albedo, kPictureEndings);
  v.file("normal", appearance.normal, kPictureEndings);
  v.file("roughness", appearance.roughness, kPictureEndings);
  v.file("occlusion", appearance.occlusion, kPictureEndings);
  v.colour("base_colour", appearance.base_colour, between(0, 1));
  v.number("roughness_factor", appearance.roughness_factor, between(0, 1));
  v.number("metallic", appearance.metallic, between(0, 1));
  v.vector2("repeat", appearance.repeat, above(0, 1e4));
}

template <class V>
void fields(V& v, Springs::Kind& kind) {
  v.number("stiffness", kind.stiffness, between(0, 1e9, "N/m"));
  v.number("damping", kind.damping, between(0, 1e6, "N s/m"));
}

template <class V>
void fields(V& v, Springs& springs) {
  v.object("structural", springs.structural);
  v.object("shear", springs.shear);
  v.object("bend", springs.bend);
  v.number("mass", springs.mass, between(0, 1e3, "kg"));
}

template <class V>
void fields(V& v, Cloth& cloth) {
  v.text("name", cloth.name);
  v.optional_object("grid", cloth.grid);
  v.file("mesh", cloth.mesh, kMeshEndings);
  v.object("transform", cloth.transform);
  v.object("start", cloth.start);
  v.fabric("fabric", cloth.fabric);
  v.flag("bending", cloth.bending);
  v.choice("bend_rest", cloth.bend_rest, kBendRests);
  v.tethers("tethers", cloth);
  v.optional_object("springs", cloth.springs);
  v.list("anchors", cloth.anchors, 0, kMostAnchors);
  v.object("appearance", cloth.appearance);
}

/// A collider's keys that belong to some shapes only.
struct ShapeKey {
  std::string_view key;
  std::array<bool, kShapes.size()> of;   // which shapes have it
};
inline constexpr ShapeKey kShapeKeys[] = {
    {"normal", {true, false, false, false, false}}, {"radius", {false, true, true, false, false}}, {"length", {false, false, true, false, false}},
    {"size", {false, false, false, true, false}},   {"axis", {false, false, true, true, true}},    {"degrees", {false, false, false, true, true}},
    {"mesh", {false, false, false, false, true}},   {"scale", {false, false, false, false, true}}, {"thickness", {false, false, false, false, true}},
};

template <class V>
void fields(V& v, Collider& collider) {
  v.choice("shape", collider.shape, kShapes);
  v.file("mesh", collider.mesh, kMeshEndings);
  v.number("scale", collider.scale, above(0, 1e6));
  v.number("thickness", collider.thickness, between(0, 1, "m"));
  v.vector3("centre", collider.centre, kPlace);
  v.unit("normal", collider.normal);
  v.number("radius", collider.radius, above(0, kFarthest, "m"));
  v.number("length", collider.length, above(0, kFarthest, "m"));
  v.vector3("size", collider.size, above(0, kFarthest, "m"));
  v.unit("axis", collider.axis);
  v.number("degrees", collider.degrees, kTurn);
  v.number("friction", collider.friction, kFriction);
  v.list("keys", collider.keys, 0, kMostKeys);
  v.colour("colour", collider.colour, between(0, 1));
}

template <class V>
void fields(V& v, SolverSettings& solver) {
  v.number("rate", solver.rate, above(0, 1e4, "Hz"));
  v.whole("substeps", solver.substeps, between(0, 1000));
  v.whole("iterations", solver.iterations, between(1, 1000));
  v.choice("method", solver.method, kMethods);
  v.optional_number("budget_ms", solver.budget_ms, above(0, 1e4, "ms"));
  v.choice("linear", solver.linear, kLinears);
  v.choice("averaging", solver.averaging, kAveragings);
  v.number("relaxation", solver.relaxation, below(0, 2));
  v.number("rho", solver.rho, below(0, 1));
  v.number("longest_advance", solver.longest_advance, above(0, 10, "s"));
}

/// The object form of `contacts`; to write it is to ask for contacts.
template <class V>
void fields(V& v, Contacts& contacts) {
  v.flag("enabled", contacts.enabled);
  v.whole("iterations", contacts.iterations, between(1, 100));
  v.number("recover", contacts.recover, between(0, 100, "m/s"));
  v.number("patience", contacts.patience, between(0, 1e6));
  v.whole("capacity", contacts.capacity, between(0, kMostCandidates));
  v.number("cell", contacts.cell, between(0, 1e3, "m"));
  v.number("reach", contacts.reach, between(0, 1e3, "m"));
}

template <class V>
void fields(V& v, Camera& camera) {
  v.vector3("eye", camera.eye, kPlace);
  v.vector3("target", camera.target, kPlace);
  v.number("fov_degrees", camera.fov_degrees, between(1, 170, "degrees"));
}

template <class V>
void fields(V& v, Light& light) {
  v.direction("direction", light.direction);
  v.colour("colour", light.colour, between(0, 100));
  v.number("sun", light.sun, between(0, 1e4));
  v.number("sky", light.sky, between(0, 1e4));
}

template <class V>
void fields(V& v, Scene& scene) {
  v.note("$schema");
  v.text("name", scene.name);
  v.text("description", scene.description);
  v.whole("frames", scene.frames, between(0, 1'000'000));
  v.vector3("gravity", scene.gravity, between(-1e3, 1e3, "m/s^2"));
  v.object("solver", scene.solver);
  v.contacts("contacts", scene.contacts);
  v.list("cloths", scene.cloths, 1, kMostCloths);
  v.list("colliders", scene.colliders, 0, kMostColliders);
  v.object("camera", scene.camera);
  v.object("light", scene.light);
}

}  // namespace weft::scene_fields
