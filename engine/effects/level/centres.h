// What the nodes of coarse levels weigh, and where their centres are. Internal.
#pragma once

#include <span>

#include "engine/effects/level/coarsen.h"

namespace weft::cooking {

/// A weighted mean: of points, by their numbers, and weights that sum to one.
using Mean = std::vector<std::pair<std::uint32_t, double>>;

struct Weighed {
  std::vector<double> masses;   // kg, of each node: what it carries, by shares; 0: it is held
  std::vector<Mean> centres;    // of each node: its centre of mass, of the finer level's centres
  std::vector<Mean> in_nodes;   // the same, of where the nodes are in the unstrained surface
};

/// A level's nodes. `shares`: the level's as they are used, rounded; `masses`: of its points (kg; 0: held); `in_points`: where the points'
/// own centres are, by the points; empty: right there.
Weighed weigh(const Coarse& level, std::span<const Share> shares, std::span<const double> masses, std::span<const Mean> in_points);

/// Makes the links of a level as long as its centres are apart when the surface is unstrained: with what lies in the plane of the link and
/// its neighbours, unrolled, as geodesics tell.
void measure_between_centres(Coarse& level, std::span<const Mean> in_nodes);

}  // namespace weft::cooking
