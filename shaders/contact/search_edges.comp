// search_edges: broad phase. Every edge searches for the edges near it (search.glsl) that come after it, cluster by cluster.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)
READ_WRITE(uint, displacement_bounds)
GATHER_UINT4(cluster_edges)
WRITE(uvec2, near_edges)
GATHER(velocities)

#include "contact/track.glsl"
#include "contact/search.glsl"
#include "contact/mask.glsl"
#include "contact/groups.glsl"
#include "contact/rare.glsl"
#include "contact/ask_to_hold.glsl"

#include "contact/search_edges.glsl"

bool may_meet(Outline other, vec3 m, vec3 relative, float reach) { return edge_may_meet(other, m, relative, reach); }
uvec2 members_of(uint cluster) { return edges_of(cluster); }
uint outline_number(uint member) { return number_of_edge(member); }
bool can_be_pair(uint member, out uvec4 particles) { return can_pair_with_edge(member, particles); }
void put_near(uint place, uint member) { near_edges[place] = uvec2(edge, member); }

// push.count: edges.
void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  searching_edge(gl_GlobalInvocationID.x);
  const NearList near = list_of(own_cluster);
  if (!near.every_one) search_listed(of_edges, own_cluster, near, false, false);
  end_search(of_edges);
  if (overflowed != 0) ask_to_hold(ends);
}
