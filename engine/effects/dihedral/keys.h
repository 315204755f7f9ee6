// The rest shape that a cloth bends about. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

inline constexpr std::array<std::string_view, 2> kBendRests = {"flat", "mesh"};

template <class V>
void keys_of_dihedral(V& v, Cloth& cloth) {
  v.choice("bend_rest", cloth.bend_rest, kBendRests);
}

}  // namespace weft::scene_fields
