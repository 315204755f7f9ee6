// How many places of cloth hands may hold at a time. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void keys_of_grab(V& v, Scene& scene) {
  v.whole("grabs", scene.grabs, between(0, kMostGrabs));
}

}  // namespace weft::scene_fields
