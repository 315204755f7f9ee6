// How large the cells of cloth are, and cloth itself, for the round bodies that it meets.
#pragma once

#include <cmath>
#include <vector>

#include "engine/fabric.h"
#include "engine/scene.h"

namespace weft {

struct Weave {
  double circle = 0;             // m: the largest of the smallest circles about its triangles: their radius
  double thickness = INFINITY;   // m, the least
  double area = 0;               // m^2
  std::uint32_t triangles = 0;
};

/// Of each cloth, as it is cooked.
std::vector<Weave> weaves_of(const CookedFabric& fabric);

/// Whether it is a sphere or a capsule.
bool is_round(const Collider& collider);

/// Of one that is round (m): of a capsule its thinner end's.
double radius_of(const Collider& collider);

/// Whether cloth is wide for it: whether its radius is less than that part of the cloth's width, the root of its area.
bool is_thin(const Collider& collider, const Weave& weave, double part);

}  // namespace weft
