// When a cloth tears. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void fields(V& v, Tear& tear) {
  v.number("strain", tear.strain, between(0.01, 1e3));
  v.text("map", tear.map);
  v.whole("spare", tear.spare, between(0, 1e6));
}

template <class V>
void keys_of_tear(V& v, Cloth& cloth) {
  v.optional_object("tear", cloth.tear);
}

}  // namespace weft::scene_fields
