// The air. Internal.
#pragma once

#include "engine/effects/ranges.h"
#include "shaders/shared.h"

namespace weft::scene_fields {

constexpr Range kCoefficient = between(0, 10);
constexpr Range kAirSpeed = between(-kFastestWind, kFastestWind, "m/s");

template <class V>
void fields(V& v, Air::Gust& gust) {
  v.vector3("velocity", gust.velocity, kAirSpeed);
  v.number("period", gust.period, between(0.01, 1e6, "s"));
  v.number("phase", gust.phase, kTurn);
}

inline constexpr std::array<std::string_view, 4> kFieldShapes = {"box", "sphere", "jet", "vortex"};

template <class V>
void fields(V& v, Air::Field& field) {
  v.choice("shape", field.shape, kFieldShapes);
  v.vector3("centre", field.centre, kPlace);
  v.vector3("velocity", field.velocity, kAirSpeed);
  v.vector3("size", field.size, above(0, kFarthest, "m"));
  v.number("radius", field.radius, between(1e-3, kFarthest, "m"));
  v.number("falloff", field.falloff, between(0, kFarthest, "m"));
}

template <class V>
void fields(V& v, Air& air) {
  v.number("density", air.density, between(0, 1e4, "kg/m^3"));
  v.number("drag", air.drag, kCoefficient);
  v.number("lift", air.lift, kCoefficient);
  v.number("friction", air.friction, kCoefficient);
  v.vector3("wind", air.wind, kAirSpeed);
  v.list("gusts", air.gusts, 0, WEFT_AIR_GUSTS);
  v.list("fields", air.fields, 0, WEFT_AIR_FIELDS);
  v.flag("lee", air.lee);
  v.number("turbulence", air.turbulence, between(0, 1e3, "m/s"));
  v.number("eddy", air.eddy, between(1e-3, 1e4, "m"));
}

template <class V>
void keys_of_air(V& v, Scene& scene) {
  v.optional_object("air", scene.air);
}

}  // namespace weft::scene_fields
