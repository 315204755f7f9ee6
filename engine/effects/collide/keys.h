// Colliders of every shape, meshes included. Internal.
#pragma once

#include "engine/effects/key_fields.h"

namespace weft::scene_fields {

constexpr std::size_t kMostColliders = 1024;
inline constexpr std::array<std::string_view, 5> kShapes = {"plane", "sphere", "capsule", "box", "mesh"};

/// A key that only some shapes of collider have.
struct ShapeKey {
  std::string_view key;
  std::array<bool, kShapes.size()> of;   // which shapes have it
};
inline constexpr ShapeKey kShapeKeys[] = {
    {"normal", {true, false, false, false, false}},    {"radius", {false, true, true, false, false}},
    {"radius_end", {false, false, true, false, false}},
    {"length", {false, false, true, false, false}},    {"size", {false, false, false, true, false}},
    {"axis", {false, false, true, true, true}},        {"degrees", {false, false, false, true, true}},
    {"mesh", {false, false, false, false, true}},      {"scale", {false, false, false, false, true}},
    {"thickness", {false, false, false, false, true}}, {"skin", {false, false, false, false, true}},
    {"bone", {true, true, true, true, false}},         {"resizes", {false, true, true, true, false}},
};

template <class V>
void fields(V& v, Bone& bone) {
  v.text("cloth", bone.cloth);
  v.text("joint", bone.joint);
}

template <class V>
void fields(V& v, Collider& collider) {
  v.choice("shape", collider.shape, kShapes);
  v.file("mesh", collider.mesh, kMeshEndings);
  v.number("scale", collider.scale, above(0, 1e6));
  v.number("thickness", collider.thickness, between(0, 1, "m"));
  v.vector3("centre", collider.centre, kPlace);
  v.unit("normal", collider.normal);
  v.number("radius", collider.radius, above(0, kFarthest, "m"));
  v.optional_number("radius_end", collider.radius_end, above(0, kFarthest, "m"));
  v.number("length", collider.length, above(0, kFarthest, "m"));
  v.vector3("size", collider.size, above(0, kFarthest, "m"));
  v.unit("axis", collider.axis);
  v.number("degrees", collider.degrees, kTurn);
  v.number("friction", collider.friction, kFriction);
  v.optional_object("skin", collider.skin);
  v.optional_object("bone", collider.bone);
  v.optional_texts("meets", collider.meets, kMostCloths);
  v.flag("resizes", collider.resizes);
  v.list("keys", collider.keys, 0, kMostKeys);
  v.colour("colour", collider.colour, between(0, 1));
}

template <class V>
void keys_of_collide(V& v, Scene& scene) {
  v.list("colliders", scene.colliders, 0, kMostColliders);
}

}  // namespace weft::scene_fields
