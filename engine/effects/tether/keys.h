// Tethers: true, false, or an object. Internal.
#pragma once

#include <optional>

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

/// The object form of `tethers`, flat in Cloth.
struct Tethers {
  std::uint32_t per_vertex = Cloth{}.tethers_per_vertex;
  std::optional<double> slack;
};

template <class V>
void fields(V& v, Tethers& tethers) {
  v.whole("per_vertex", tethers.per_vertex, between(1, 8));
  v.optional_number("slack", tethers.slack, between(0, 1));
}

template <class V>
void keys_of_tether(V& v, Cloth& cloth) {
  v.tethers("tethers", cloth);
}

}  // namespace weft::scene_fields
