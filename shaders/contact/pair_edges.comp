// pair_edges: narrow phase. Of the near edges, those that may meet before the next detection (pair.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT4(cluster_edges)
READ(uvec2, near_edges)

#include "contact/narrow.glsl"

#include "contact/pair_edges.glsl"

// push.count: places in near_edges.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < min(push.count, detection[0].near[of_edges])) pair_edge(near_edges[i]);
}
