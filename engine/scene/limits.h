// Sizes, and whether a number is what a table (engine/scene/fields.h) allows, and the sentence if it is not. Internal.
#pragma once

#include <string>

#include "engine/effects/ranges.h"

namespace weft {

/// Ten digits, in which what an author wrote comes back; of a float six.
std::string number_text(double value);
std::string number_text(float value);

/// What is wrong with a number of this range; empty when it is in it. Not finite is outside of every range.
std::string outside(double value, const scene_fields::Range& range);
std::string outside(float value, const scene_fields::Range& range);

/// Vertices of all cloths and mesh colliders that are made for a scene: as many as the largest grid has. Cooking takes about 1.2 kB
/// for each, so that no scene file, however short, takes more than 5 GB.
inline constexpr double kMostSceneVertices = 4'200'000;

/// Of any numbers of cells, so that it must not be an integer.
double vertices_of(const Grid& grid);
/// Why the scene's grids are too large together, as what follows "cloths: "; empty if they are not.
std::string size_fault(const Scene& scene);

}  // namespace weft
