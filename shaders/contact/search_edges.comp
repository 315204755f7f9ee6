// search_edges: broad phase. Every edge searches for the edges near it (search.glsl) that come after it, cluster by cluster; and where
// something may have crossed, for triangles that it goes through (untangle/crossing.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT4(cluster_edges)
WRITE(uvec2, near_edges)
GATHER(velocities)

#include "contact/search.glsl"
#include "contact/mask.glsl"
#include "untangle/crossing.glsl"

uint edge, own_cluster;
uvec2 ends;

// Separating axis m: the gap along m is |m| less the half extents of both edges along it. In a flat sheet that rejects all but the nearest
// edges, which boxes do not.
bool may_meet(Outline other, vec3 m, vec3 relative, float reach) {
  const float squared = dot(m, m);
  const float stopped = max(abs(dot(m, own.trajectory)), abs(dot(m, other.trajectory))) * per_substep();
  const float halves = abs(dot(m, own.half_sides)) + abs(dot(m, other.half_sides));
  return squared * (1 - 4 * rounding) <= halves + abs(dot(m, relative)) + stopped + sqrt(squared) * reach;
}

uvec2 members_of(uint cluster) {
  return uvec2(cluster == own_cluster ? edge + 1 : FETCH(clusters, cluster).y, FETCH(clusters, cluster + 1).y);
}
uint outline_number(uint member) { return contact_settings.triangles + member; }

bool can_be_pair(uint member, out uvec4 particles) {
  const uvec2 e = FETCH(cluster_edges, member).xy;
  particles = uvec4(ends, e);
  bool can = ends.x != e.x && ends.x != e.y && ends.y != e.x && ends.y != e.y;
  if (contact_mask_words > 0) can = can && meets_other(ends.x, e.x);
  return can;
}

void put_near(uint place, uint member) { near_edges[place] = uvec2(edge, member); }

// push.count: edges.
void main() {
  edge = gl_GlobalInvocationID.x;
  if (edge >= push.count) return;
  const uvec4 e = FETCH(cluster_edges, edge);
  ends = e.xy;
  own_cluster = e.z;
  own = outline_at(outline_number(edge));
  search(of_edges, own_cluster, false, false);
  end_search(of_edges, own_cluster, false);
  if (untangles && detection[0].looks != 0) search_crossings(edge, ends, own_cluster);
}
