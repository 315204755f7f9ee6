// Clusters: neighbouring triangles that contact detection treats as one until it looks closer.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/effects/effect.h"

namespace weft {

/// Every triangle, edge and particle belongs to one cluster; a cluster's members lie beside each other.
struct ClusterLists {
  std::vector<gpu::uvec4> clusters;    // first face, first edge, first of `hulls`, unused; one more at the end
  std::vector<gpu::uvec4> faces;       // three particles, the cluster
  std::vector<gpu::uvec4> edges;       // two particles, the cluster; on a rim 1 more than the third particle of its triangle, else 0
  std::vector<gpu::uvec2> searchers;   // particle, its cluster
  std::vector<std::uint32_t> hulls;    // particles of a cluster's faces, and those that belong to it besides
  std::vector<std::uint32_t> memberships;   // of each particle: where its clusters begin in this list, one more at the end; then clusters,
                                            // of each particle first its own, then the others in whose hulls it is
  std::vector<gpu::uvec4> surroundings;   // of each cluster: first of `around`, end of those that it touches, end, bits of the least
                                          // eigenvalue that makes it smooth (smooth.h)
  std::vector<std::uint32_t> around;      // clusters: itself and those that it touches, then the others of a convex piece about them
};

namespace cooking {

/// From the triangles, edges and rest positions of all bodies. A cluster has up to WEFT_CLUSTER triangles of one cloth or mesh collider, in
/// one piece, or as many particles without a triangle.
ClusterLists make_clusters(const CookedFabric& fabric);

}  // namespace cooking
}  // namespace weft
