// The gas in a closed cloth. Internal.
#pragma once

#include "engine/effects/ranges.h"

namespace weft::scene_fields {

constexpr Range kPressure = between(0, 1e7, "Pa");

template <class V>
void fields(V& v, Gas& gas) {
  v.number("rest_pressure", gas.rest_pressure, kPressure);
  v.number("ambient", gas.ambient, kPressure);
  v.optional_number("volume", gas.volume, between(1e-12, 1e9, "m^3"));
}

template <class V>
void keys_of_pressure(V& v, Cloth& cloth) {
  v.optional_object("pressure", cloth.pressure);
}

}  // namespace weft::scene_fields
