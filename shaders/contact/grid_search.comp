// grid_search: every cluster looks into the grid for the clusters whose boxes overlap its own, and each of a pair is listed with the other.
// One that it touches in the mesh is marked, and clusters are found smooth: the search then passes over what cannot meet (search.glsl).
// The order of a list differs from run to run; no result depends on it. Where a list has no room the count alone goes on, and those who
// read it ask all clusters instead (search.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(cluster_boxes)
GATHER(cluster_motions)
GATHER_UINT(grid_starts)
GATHER(grid_entries)
READ_WRITE(uint, near_clusters)
READ_WRITE(uint, cluster_pushes)
WRITE(uint, smooth_clusters)
READ(Detection, detection)

#include "contact/apart.glsl"
#include "contact/grid.glsl"
#include "contact/cluster.glsl"
#include "contact/latest_box.glsl"
#include "contact/smooth.glsl"

#include "contact/find_near.glsl"

// push.count: clusters.
void main() {
  if (gl_GlobalInvocationID.x < push.count) find_near(gl_GlobalInvocationID.x);
}
