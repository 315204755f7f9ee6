// What cloth feels of the motion of the frame that it goes with. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void fields(V& v, Inertia& inertia) {
  v.number("linear", inertia.linear, between(0, 1));
  v.number("angular", inertia.angular, between(0, 1));
  v.number("centrifugal", inertia.centrifugal, between(0, 1));
  v.text("joint", inertia.joint);
}

template <class V>
void keys_of_inertia(V& v, Cloth& cloth) {
  v.optional_object("inertia", cloth.inertia);
}

}  // namespace weft::scene_fields
