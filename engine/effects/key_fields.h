// The table of a pose at a time: what moves has a list of these. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void fields(V& v, Key& key) {
  v.number("time", key.time, between(0, 1e6, "s"));
  v.vector3("translate", key.translate, kPlace);
  v.unit("axis", key.axis);
  v.number("degrees", key.degrees, kTurn);
}

}  // namespace weft::scene_fields
