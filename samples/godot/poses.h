// A node's pose as Weft's scenes have it: a translation, an axis and an angle.
//
// What moves cloth in Godot is also what `weft run` plays from a scene file, bit for bit. A scene turns a collider by a key's quaternion
// and makes the product with its rotation at rest of length 1. A key from here has a quaternion to which that does nothing; its angle is
// off by some 1e-8 of itself for that, less than what floats tell apart, and near half a turn by a thousandth of a degree at most.
#pragma once

#include <optional>

#include "engine/scene.h"
#include "samples/godot/godot.h"

namespace weft_godot {

/// A transform of Godot's, taken apart. None: it is sheared or mirrored, or of no size.
struct Placed {
  weft::Vec3 at;
  weft::Rotation rotation;
  weft::Vec3 scale{1, 1, 1};
};
std::optional<Placed> placed(const godot::Transform& transform);
/// Whether a scale is the same along all axes, up to a thousandth.
bool is_even(weft::Vec3 scale);

/// The key for a pose; `before` is the one of the tick before. Two keys in a row that turn have different axes, so that Weft takes the
/// rotation between two keys from their quaternions, as it does for a host.
weft::Key key_of(weft::Vec3 at, const weft::Rotation& rotation, const weft::Key& before);

/// What a rotation does to a point, as a transform has it.
godot::Transform operator*(const godot::Transform& a, const godot::Transform& b);
weft::Vec3 operator*(const godot::Transform& a, weft::Vec3 p);
/// Of a transform without shear.
std::optional<godot::Transform> inverse(const godot::Transform& transform);

}  // namespace weft_godot
