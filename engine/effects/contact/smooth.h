// Around every cluster of a flat cloth: where no two places can meet as long as the cloth there is smooth, so that detection need not look.
//
// Let x(u) be where the place u of the rest plane is, and F two orthonormal directions. Two places p and q whose straight line at rest runs
// through triangles of deformation gradient J lie apart, along F (q - p), by the integral of (q - p)^T F^T J (q - p) / |q - p|: by at least
// c |q - p| where the symmetric part of F^T J has no eigenvalue below c. So it suffices that all triangles about a cluster are so, that
// these cover a convex piece of the plane with the cluster and those that it touches in it, and that c times the least distance at rest of
// what is no neighbour is above the thickness. (After the normal cones of Volino and Thalmann 1994 and Provot 1997, which say nothing of
// distances.)
#pragma once

#include <cstdint>
#include <vector>

#include "engine/effects/contact/clusters.h"

namespace weft::cooking {

/// Makes ClusterLists::surroundings and ClusterLists::around of the clusters. Empty for those without triangles, not flat at rest with their
/// surroundings, by a notch or a hole, or too fine for their thickness.
void find_surroundings(const CookedFabric& fabric, ClusterLists& lists);

}  // namespace weft::cooking
