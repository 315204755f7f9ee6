// cluster_box: the box of every cluster, about its particles' trajectories, and its motion, by which it may be smooth (smooth.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT4(clusters)
GATHER_UINT4(cluster_faces)
GATHER_UINT(cluster_hulls)
GATHER(positions)
GATHER(detected_positions)
GATHER(trajectories)
READ(Detection, detection)
WRITE(vec4, cluster_boxes)
WRITE(vec4, cluster_motions)
WRITE(uint, near_clusters)
WRITE(uint, cluster_pushes)
WRITE(uint, near_bounds)
GATHER_UINT(memberships)

#include "contact/apart.glsl"
#include "contact/grid.glsl"
#include "contact/cluster.glsl"

#include "contact/predicted_track.glsl"
#include "contact/make_box.glsl"

// push.count: clusters.
void main() {
  const uint cluster = gl_GlobalInvocationID.x;
  if (cluster < push.count) make_box(cluster);
}
