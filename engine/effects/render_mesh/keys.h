// The finer mesh that a cloth carries. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void keys_of_render_mesh(V& v, Cloth& cloth) {
  v.file("render_mesh", cloth.render_mesh, kMeshEndings);
}

}  // namespace weft::scene_fields
