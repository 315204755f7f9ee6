// search_rare: what a search seldom has to do. Where more clusters are near than a list has room for it looks at all; where it has found
// more pairs than there is room for it searches again, to hold them; where something may have crossed, every edge looks for triangles that
// it goes through (untangle/crossing.glsl). In the passes of the search themselves, threads that go through both sides of every branch
// would do it each time.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)
READ_WRITE(uint, displacement_bounds)
GATHER_UINT2(cluster_searchers)
GATHER_UINT4(cluster_edges)
GATHER(velocities)

#include "contact/track.glsl"
#include "contact/search.glsl"
#include "contact/mask.glsl"
#include "untangle/crossing.glsl"   // with cluster_faces
#include "contact/search_faces.glsl"
#include "contact/search_edges.glsl"
#include "contact/own_search.glsl"

WRITE(uvec2, near_faces)
WRITE(uvec2, near_edges)
void put_near(uint place, uint member) {
  if (is_edge) near_edges[place] = uvec2(edge, member);
  else near_faces[place] = uvec2(vertex, member);
}

// push.count: particles and edges, in this order.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const uint cluster = begin_search(i), kind = is_edge ? of_edges : of_triangles;
  const uvec2 particles = is_edge ? ends : uvec2(vertex);
  const NearList near = list_of(cluster);
  if (near.every_one) search_all(kind, cluster, !is_edge, false);
  end_search(kind);
  const bool has_overflowed = displacement_bounds[particles.x] == 0 && displacement_bounds[particles.y] == 0;   // ask_to_hold
  if (near.every_one && overflowed != 0) search_all(kind, cluster, !is_edge, true);
  if (!near.every_one && has_overflowed) search_listed(kind, cluster, near, !is_edge, true);
  if (untangles && is_edge && detection[0].looks != 0) search_crossings(edge, ends, own_cluster);
}
