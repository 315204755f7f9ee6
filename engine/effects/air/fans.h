// Fans: the triangles about each particle, in the order in which they lie, as wide as the air asks for.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/vector.h"
#include "shaders/shared.h"

namespace weft {

/// Of a particle's triangles: the two other particles, in winding order, and a third of the rest area (m^2).
struct AirCorner {
  std::uint32_t from, to;
  float third;
};

/// The surface of all cloths, a particle each.
struct AirSurface {
  std::vector<std::vector<AirCorner>> corners;
  std::vector<Vec3> places;   // m, at rest
};

/// The fans of each particle, one after another: particles in winding order, each with a third of the rest area (m^2, as float bits) of the
/// triangle between it and the one before; 0 for the first of a fan. They are not the neighbours, but particles as far off as the air evens
/// out, along the cloth, the ways in which the neighbours lie; nearer where the cloth ends or turns.
std::vector<std::vector<gpu::uvec2>> fans_of(const AirSurface& surface);

}  // namespace weft
