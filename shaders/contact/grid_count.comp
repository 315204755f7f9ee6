// grid_count: makes the box of every cluster, about its particles' trajectories, counts the clusters of every bucket of the grid, and finds
// the longest box on each level.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT4(clusters)
GATHER_UINT(cluster_hulls)
WRITE(vec4, cluster_boxes)
WRITE(uint, near_clusters)
READ_WRITE(uint, grid_counts)
READ_WRITE(Detection, detection)

#include "contact/cluster.glsl"

Box box_of(uint cluster) {
  Box box = Box(vec3(1e30), vec3(-1e30));
  const uint end = FETCH(clusters, cluster + 1).z;
  for (uint k = FETCH(clusters, cluster).z; k < end; ++k) {
    const uint i = FETCH_UINT(cluster_hulls, k);
    const Sweep sweep = sweep_of(track_of(i), FETCH(rest, i).w);
    box = Box(min(box.low, sweep.low), max(box.high, sweep.high));
  }
  return box;
}

// push.count: clusters.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const Box box = box_of(i);
  cluster_boxes[2 * i] = vec4(box.low, 0);
  cluster_boxes[2 * i + 1] = vec4(box.high, 0);
  near_clusters[(WEFT_NEAR_CLUSTERS + 1) * i] = 0;   // its list begins empty (grid_search)
  const Place place = place_of(box);
  atomicAdd(grid_counts[place.bucket], 1u);
  // Bits of floats that are not negative order like integers. Most boxes are no longer than the longest so far, and need no atomic.
  const uint bits = floatBitsToUint(place.half_side);
  if (detection[0].extents[place.level] < bits) {
    atomicMax(detection[0].extents[place.level], bits);
    atomicOr(detection[0].levels, 1u << place.level);
  }
}
