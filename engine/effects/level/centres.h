// What the nodes of coarse levels weigh, and where their centres are. Internal.
#pragma once

#include <span>

#include "engine/effects/level/coarsen.h"

namespace weft::cooking {

/// A weighted mean: of points, by their numbers, and weights that sum to one.
using Mean = std::vector<std::pair<std::uint32_t, double>>;

/// A point of the finer level as a node has it: its weight in the node's centre of mass, and in its middle, which is the mean of nearer ones.
struct Gathered {
  std::uint32_t point;
  double in_centre, in_middle;
};

struct Weighed {
  std::vector<double> masses;                    // kg, of each node: what it carries, by shares; 0: it stays where it is
  std::vector<bool> weightless;                  // of each node: it stays because what it carries weighs nothing, and not because it is held
  std::vector<std::vector<Gathered>> gathers;    // of each node, of the finer level's centres and middles; both weights sum to one
  std::vector<Mean> in_nodes;                    // of each node's middle: where it is in the unstrained surface, by the nodes
};

/// What a level's points weigh (kg; 0: they stay), and which of those that stay are not held; empty: none.
struct Weights {
  std::vector<double> masses;
  std::vector<bool> weightless = {};
  bool is_held(std::uint32_t point) const { return masses[point] == 0 && !(point < weightless.size() && weightless[point]); }
};

/// A level's nodes. `shares`: the level's as they are used, rounded; `in_points`: where the points' own middles are, by the points; empty: right
/// there. `even_held`: nodes keep places for points that are held, so that lists are as long whoever is.
enum class Middles { known, unknown };   // unknown: without Weighed::in_nodes
Weighed weigh(const Coarse& level, std::span<const Share> shares, const Weights& points, std::span<const Mean> in_points,
              bool even_held = false, Middles middles = Middles::known);

/// Makes the links of a level as long as middles are apart when the surface is unstrained, with what lies around them unrolled into a plane,
/// as geodesics tell.
void measure_between_middles(Coarse& level, std::span<const Mean> in_nodes);

}  // namespace weft::cooking
