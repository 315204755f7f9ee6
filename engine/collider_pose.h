// The pose of a collider, and its size.
#pragma once

#include "engine/vector.h"

namespace weft {

/// The pose of one of the scene's colliders in a frame.
struct ColliderPose {
  Vec3 centre;           // m
  Vec3 normal{0, 1, 0};  // unit; planes only
  Rotation rotation{};   // from the shape's own axes: a capsule lies along y, a box has its sides along x, y, z; spheres spin by it
  bool operator==(const ColliderPose&) const = default;
};

/// The size of one of the scene's colliders; what its shape does not have is ignored.
struct ColliderSize {
  double radius = 0.5;       // m, spheres and capsules
  double radius_end = 0.5;   // m, capsules: at the end to which its axis points
  double length = 0.5;       // m, capsules: from the centre of one end's sphere to the other's
  Vec3 size{1, 1, 1};        // m, boxes: whole sides
  bool operator==(const ColliderSize&) const = default;
};

}  // namespace weft
