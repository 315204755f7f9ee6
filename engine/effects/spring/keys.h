// Springs, for the methods mass_spring, verlet and implicit. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void fields(V& v, Springs::Kind& kind) {
  v.number("stiffness", kind.stiffness, between(0, 1e9, "N/m"));
  v.number("damping", kind.damping, between(0, 1e6, "N s/m"));
}

template <class V>
void fields(V& v, Springs& springs) {
  v.object("structural", springs.structural);
  v.object("shear", springs.shear);
  v.object("bend", springs.bend);
  v.number("mass", springs.mass, between(0, 1e3, "kg"));
}

template <class V>
void keys_of_spring(V& v, Cloth& cloth) {
  v.optional_object("springs", cloth.springs);
}

}  // namespace weft::scene_fields
