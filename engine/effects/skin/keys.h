// What moves a skin. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

template <class V>
void fields(V& v, Skinning& skin) {
  v.text("animation", skin.animation);
  v.number("speed", skin.speed, between(0, 100));
  v.number("start", skin.start, between(0, 1e6, "s"));
  v.flag("loops", skin.loops);
  v.flag("takes_targets", skin.takes_targets);
}

template <class V>
void keys_of_skin(V& v, Cloth& cloth) {
  v.optional_object("skin", cloth.skin);
}

}  // namespace weft::scene_fields
