// Reactions. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void keys_of_reaction(V& v, Scene& scene) {
  v.flag("reactions", scene.reactions);
}

}  // namespace weft::scene_fields
