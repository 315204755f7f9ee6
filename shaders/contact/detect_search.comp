// detect_search: search_faces and search_edges in one dispatch, on a GPU. Threads do one or the other.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)
READ_WRITE(uint, displacement_bounds)
GATHER_UINT2(cluster_searchers)
GATHER_UINT4(cluster_edges)
WRITE(uvec2, near_faces)
WRITE(uvec2, near_edges)
GATHER(velocities)

#include "contact/track.glsl"
#include "contact/search.glsl"
#include "contact/mask.glsl"
#include "untangle/crossing.glsl"   // with cluster_faces
#include "contact/search_faces.glsl"
#include "contact/search_edges.glsl"

#include "contact/own_search.glsl"
#include "contact/search_either.glsl"

void put_near(uint place, uint member) {
  if (is_edge) near_edges[place] = uvec2(edge, member);
  else near_faces[place] = uvec2(vertex, member);
}

// push.count: particles and edges, in this order.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  search_either(i);
  if (untangles && is_edge && detection[0].looks != 0) search_crossings(edge, ends, own_cluster);
}
