// See samples/godot/colliders.h.
#include "samples/godot/colliders.h"

#include "samples/godot/meshes.h"

namespace weft_godot {
namespace {

using godot::Object;
using godot::Variant;
using weft::ColliderShape;
using weft::Vec3;

const Vec3 kAway{0, -9e4f, 0};   // m: as far as scenes reach

std::optional<Placed> place_of(const Variant& node, godot::Transform& at) {
  if (!node.call("is_inside_tree").to_bool() || node.call("is_disabled").to_bool()) return {};
  at = node.call("get_global_transform").to_transform();
  return placed(at);
}

}  // namespace

bool Shape::measure(const Variant& shape, Vec3 scale, std::string& fault) {
  const Object object = shape.to_object();
  const auto number = [&](const char* property) { return shape.call("get", property).to_double(); };
  const double even = (double(scale.x) + scale.y + scale.z) / 3;
  if (godot::is(object, "BoxShape3D")) {
    const Vec3 size = shape.call("get_size").to_vector3();
    collider_.shape = ColliderShape::box;
    collider_.size = {size.x * scale.x, size.y * scale.y, size.z * scale.z};
    return true;
  }
  if (godot::is(object, "ConcavePolygonShape3D")) {
    auto mesh = mesh_of_faces(shape.call("get_faces").to_vectors3(), scale);
    if (!mesh) return fault = mesh.error(), false;
    mesh_ = std::move(*mesh);
    collider_.shape = ColliderShape::mesh;
    collider_.mesh = "shape";
    return true;
  }
  if (!is_even(scale)) return fault = "it is scaled unevenly, which spheres, capsules and planes cannot be", false;
  if (godot::is(object, "SphereShape3D")) {
    collider_.shape = ColliderShape::sphere;
    collider_.radius = even * number("radius");
    return true;
  }
  if (godot::is(object, "CapsuleShape3D")) {
    collider_.shape = ColliderShape::capsule;
    collider_.radius = even * number("radius");
    collider_.length = std::max(1e-4, even * number("height") - 2 * collider_.radius);
    return true;
  }
  if (godot::is(object, "WorldBoundaryShape3D")) {
    const godot::Plane plane = shape.call("get_plane").to_plane();
    collider_.shape = ColliderShape::plane;
    collider_.normal = plane.normal;
    offset_ = float(even) * plane.d * plane.normal;
    return true;
  }
  return fault =
             "cloth does not meet a " + (object ? shape.call("get_class").to_string() : std::string("CollisionShape3D without a shape")),
         false;
}

std::optional<Shape> Shape::of(Object object, bool resizes, std::string& fault) {
  const Variant node(object);
  const Variant body = node.call("get_parent");
  if (!godot::is(body.to_object(), "PhysicsBody3D")) return {};   // areas are not solid
  Shape made;
  made.node_ = godot::id_of(object);
  const Variant shape = node.call("get_shape");
  made.shape_ = godot::id_of(shape.to_object());
  made.layers_ = static_cast<std::uint32_t>(body.call("get_collision_layer").to_int());
  const std::optional<Placed> at = placed(node.call("get_global_transform").to_transform());
  if (!at) return fault = "it is mirrored, sheared or of no size", std::nullopt;
  if (!made.measure(shape, at->scale, fault)) return {};
  made.collider_.resizes = resizes && made.collider_.shape != ColliderShape::mesh && made.collider_.shape != ColliderShape::plane;
  if (!godot::is(body.to_object(), "CharacterBody3D")) {
    const Variant material = godot::is(body.to_object(), "StaticBody3D") || godot::is(body.to_object(), "RigidBody3D")
                                 ? body.call("get_physics_material_override")
                                 : Variant();
    if (material.to_object()) made.collider_.friction = std::clamp(material.call("get_friction").to_double(), 0.0, 10.0);
  }
  made.is_away_ = true;   // until it was looked at
  if (const Change first = made.look(); first.key) made.key_ = *first.key;
  made.collider_.keys = {made.key_};
  return made;
}

Shape::Change Shape::look() {
  Change change;
  const Object object = godot::object_of(node_);
  const Variant node(object);
  godot::Transform at;
  const std::optional<Placed> place = object ? place_of(node, at) : std::nullopt;
  if (!place) {
    if (is_away_) return change;
    is_away_ = change.at_once = true;
    key_ = key_of(kAway, {}, key_);
    change.key = key_;
    return change;
  }
  const Variant shape = node.call("get_shape");
  outdated_ |= godot::id_of(shape.to_object()) != shape_;
  if (!outdated_ && collider_.shape != ColliderShape::mesh && collider_.shape != ColliderShape::plane) {
    const weft::ColliderSize before = weft::size_of(collider_);
    std::string fault;
    outdated_ |= !measure(shape, place->scale, fault);
    const weft::ColliderSize now = weft::size_of(collider_);
    // The scale is taken out of a node's axes, and comes with their rounding.
    const auto differs = [](double a, double b) { return std::abs(a - b) > 1e-5 * std::max(std::abs(a), std::abs(b)); };
    if (differs(now.radius, before.radius) || differs(now.length, before.length) || differs(now.size.x, before.size.x) ||
        differs(now.size.y, before.size.y) || differs(now.size.z, before.size.z)) {
      if (collider_.resizes) change.size = now;
      outdated_ |= !collider_.resizes;   // the next simulation's can be resized
      collider_.resizes = true;
    } else {
      collider_.radius = before.radius, collider_.length = before.length, collider_.size = before.size;
    }
  }
  if (!is_away_ && at == last_) return change;
  change.at_once = is_away_;
  is_away_ = false;
  last_ = at;
  const Vec3 centre = collider_.shape == ColliderShape::plane ? place->at + weft::rotated(place->rotation, offset_) : place->at;
  key_ = key_of(centre, place->rotation, key_);
  change.key = key_;
  return change;
}

std::vector<Shape> shapes_below(const Variant& root, const std::set<std::uint64_t>& resized, std::vector<std::string>& faults) {
  std::vector<Shape> shapes;
  const Variant found = root.call("find_children", "*", "CollisionShape3D", true, false);
  const std::int64_t count = found.call("size").to_int();
  for (std::int64_t k = 0; k < count; ++k) {
    const Variant node = found.call("get", k);
    std::string fault;
    if (auto shape = Shape::of(node.to_object(), resized.contains(godot::id_of(node.to_object())), fault))
      shapes.push_back(std::move(*shape));
    else if (!fault.empty()) faults.push_back("The shape " + node.call("get_path").to_string() + " is left out: " + fault + ".");
  }
  return shapes;
}

}  // namespace weft_godot
