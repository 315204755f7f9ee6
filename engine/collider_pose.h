// The pose of a collider.
#pragma once

#include "engine/vector.h"

namespace weft {

/// The pose of one of the scene's colliders in a frame.
struct ColliderPose {
  Vec3 centre;           // m
  Vec3 normal{0, 1, 0};  // unit; planes only
  Rotation rotation{};   // from the shape's own axes: a capsule lies along y, a box has its sides along x, y, z; spheres spin by it
};

}  // namespace weft
