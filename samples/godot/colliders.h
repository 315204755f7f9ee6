// The collision shapes of the tree, as what cloth meets.
#pragma once

#include <set>

#include "engine/mesh.h"
#include "samples/godot/poses.h"

namespace weft_godot {

/// A CollisionShape3D whose body is solid. It goes with its node; while it is disabled or away it lies where nothing is.
class Shape {
 public:
  /// None: not solid, or of a kind that cloth does not meet, which `fault` then says. `resizes`: its size has changed before.
  static std::optional<Shape> of(godot::Object node, bool resizes, std::string& fault);
  std::uint64_t node() const { return node_; }

  const weft::Collider& collider() const { return collider_; }
  const std::optional<weft::Mesh>& mesh() const { return mesh_; }   // of mesh colliders
  std::uint32_t layers() const { return layers_; }

  /// What has changed since the last call.
  struct Change {
    std::optional<weft::Key> key;
    bool at_once = false;   // it was away, or is now
    std::optional<weft::ColliderSize> size;
  };
  Change look();
  /// Whether it has another shape, or another size than it can take on without a new simulation.
  bool is_outdated() const { return outdated_; }

 private:
  bool measure(const godot::Variant& shape, weft::Vec3 scale, std::string& fault);
  std::uint64_t node_ = 0, shape_ = 0;
  weft::Collider collider_;
  std::optional<weft::Mesh> mesh_;
  weft::Vec3 offset_;   // of a plane's point, in the shape's axes
  std::uint32_t layers_ = 0;
  godot::Transform last_;
  weft::Key key_;
  bool is_away_ = false, outdated_ = false;
};

/// All solid shapes below a node, with the faults of those that are left out. `resized`: nodes whose size has changed before.
std::vector<Shape> shapes_below(const godot::Variant& root, const std::set<std::uint64_t>& resized, std::vector<std::string>& faults);

}  // namespace weft_godot
