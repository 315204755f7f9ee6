// Every key that a scene file may hold, with its limits: one table an object, written as a function over a visitor.
//
// The reader (engine/scene/reader.cpp) walks these tables to fill a Scene; the schema test walks them to compare assets/scene.schema.json
// key by key. A key that is not here does not exist. Internal: not part of the public API.
//
// A visitor has these members, each called with the key and the value it stands for:
//   text, optional_texts, flag, optional_flag, number, optional_number, stiffness (a number or "rigid"), whole, choice, choices, vector2,
// vector3, direction,
//   unit (normalised), colour, file, cells, whole_list, object, optional_object, list, fabric, tethers, contacts, note (read by
//   nobody)
#pragma once

#include <limits>

#include "engine/effects/keys.h"   // made by CMake: of every effect in engine/effects/list.h
#include "engine/effects/key_fields.h"

namespace weft::scene_fields {

template <class V>
void fields(V& v, Grid& grid) {
  v.vector2("size", grid.size, above(0, kFarthest, "m"));
  v.cells("cells", grid.cells_x, grid.cells_y, kCells);
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
  v.number("imperfection", start.imperfection, between(0, 1));
  v.whole("seed", start.seed, between(0, std::numeric_limits<std::uint32_t>::max()));
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
  v.number("thickness", fabric.thickness, kThickness);
}

template <class V>
void fields(V& v, Maps& maps) {
  v.text("mass", maps.mass);
  v.text("stretch", maps.stretch);
  v.text("bend", maps.bend);
  v.text("friction", maps.friction);
  v.text("thickness", maps.thickness);
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
  v.flag("mesh_materials", appearance.mesh_materials);
}

template <class V>
void fields(V& v, Cloth& cloth) {
  v.text("name", cloth.name);
  v.optional_object("grid", cloth.grid);
  v.file("mesh", cloth.mesh, kMeshEndings);
  v.object("transform", cloth.transform);
  v.object("start", cloth.start);
  v.fabric("fabric", cloth.fabric);
  v.object("maps", cloth.maps);
  v.optional_texts("meets", cloth.meets, kMostCloths);
  v.object("appearance", cloth.appearance);
  effect_keys(v, cloth);
}

template <class V>
void fields(V& v, SolverSettings& solver) {
  v.number("rate", solver.rate, above(0, 1e4, "Hz"));
  v.whole("substeps", solver.substeps, between(0, 1000));
  v.whole("iterations", solver.iterations, between(1, 1000));
  v.whole("bend_steps", solver.bend_steps, between(1, 4));
  v.choice("method", solver.method, kMethods);
  v.optional_number("budget_ms", solver.budget_ms, above(0, 1e4, "ms"));
  v.choice("linear", solver.linear, kLinears);
  v.choice("averaging", solver.averaging, kAveragings);
  v.number("relaxation", solver.relaxation, below(0, 2));
  v.number("rho", solver.rho, below(0, 1));
  v.whole("order", solver.order, between(1, 2));
  v.optional_flag("levels", solver.levels);
  v.flag("shifts", solver.shifts);
  v.number("longest_advance", solver.longest_advance, above(0, 10, "s"));
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
  v.list("cloths", scene.cloths, 1, kMostCloths);
  v.object("camera", scene.camera);
  v.object("light", scene.light);
  effect_keys(v, scene);
}

}  // namespace weft::scene_fields
