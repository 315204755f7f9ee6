// What cloth does to a collider, or to a hand.
#pragma once

#include "engine/vector.h"

namespace weft {

/// Of all particles that one of the scene's colliders has put out or rubbed, or parted from its triangles, or that a grab has pulled: the
/// opposite of what they were given.
struct Reaction {
  Vec3 impulse;           // N s
  Vec3 angular_impulse;   // N m s, about the collider's centre, or the grab's target, where it was at the end of each substep
};

}  // namespace weft
