// Whether a cloth resists bending. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void keys_of_bend(V& v, Cloth& cloth) {
  v.flag("bending", cloth.bending);
  v.flag("bends_as_plate", cloth.bends_as_plate);
}

}  // namespace weft::scene_fields
