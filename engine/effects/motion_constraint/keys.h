// How near particles stay to their animated places. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void fields(V& v, MotionConstraints& constraints) {
  v.number("max_distance", constraints.max_distance, between(0, kFarthest, "m"));
  v.number("stiffness", constraints.stiffness, between(0, 1));
  v.number("backstop_distance", constraints.backstop_distance, between(0, kFarthest, "m"));
  v.number("backstop_radius", constraints.backstop_radius, between(0, kFarthest, "m"));
  v.text("max_distance_map", constraints.max_distance_map);
  v.text("stiffness_map", constraints.stiffness_map);
  v.text("backstop_map", constraints.backstop_map);
}

template <class V>
void keys_of_motion_constraint(V& v, Cloth& cloth) {
  v.optional_object("motion_constraints", cloth.motion_constraints);
}

}  // namespace weft::scene_fields
