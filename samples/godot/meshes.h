// Meshes of Godot's as Weft's, and back: a cloth's mesh is drawn as Weft has it, vertex by vertex.
//
// Godot's front faces run clockwise and Weft's the other way, so triangles turn round on the way in and out. A surface is a material.
#pragma once

#include "engine/mesh.h"
#include "samples/godot/godot.h"

namespace weft_godot {

/// From a Mesh resource, in its own axes. Vertices count through all of its surfaces, one after another (Mesh::point_of_source). Vertex
/// colours are the attribute COLOR_0. Of a mesh with bones the skin has weights and joints without nodes, for Skin::bind. Errors: no mesh,
/// a surface that is not of triangles, what weld_mesh refuses.
weft::Result<weft::Mesh> mesh_of(const godot::Variant& mesh);
/// From triangles' corners (ConcavePolygonShape3D), scaled.
weft::Result<weft::Mesh> mesh_of_faces(std::span<const weft::Vec3> corners, weft::Vec3 scale);

/// An ArrayMesh with a surface for each surface that the mesh was made of and that has triangles left; `surfaces` receives their numbers.
/// CUSTOM0.x of a vertex is its number in the mesh, by which the shader finds it.
godot::Variant drawn_mesh(const weft::RenderMesh& mesh, std::vector<std::uint32_t>& surfaces);

/// The bounding box of some points.
godot::Box box_of(std::span<const weft::Vec3> points);

}  // namespace weft_godot
