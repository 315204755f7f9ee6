// search_edges: broad phase. Every edge searches for the edges near it (search.glsl). The edge on the lower level finds the other one; for
// two on one level see Search.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT2(edges)
WRITE(uvec2, near_edges)

#include "contact/search.glsl"

uint edge;
uvec2 ends;
vec3 half_edge;

// Separating axis m: the gap along m is |m| less the half extents of both edges along it. In a flat sheet that rejects all but the nearest
// edges, which boxes do not.
bool may_meet(vec3 m, vec3 its_half, float slack) {
  const float squared = dot(m, m);
  return squared <= abs(dot(m, half_edge)) + abs(dot(m, its_half)) + (1 + rounding) * sqrt(squared) * slack;
}

uvec4 particles_with(uint primitive) {
  const uvec2 e = FETCH_UINT2(edges, primitive - contact_settings.triangles);
  return ends.x == e.x || ends.x == e.y || ends.y == e.x || ends.y == e.y ? uvec4(WEFT_NONE) : uvec4(ends, e);
}

void put_near(uint place, uint primitive) { near_edges[place] = uvec2(edge, primitive - contact_settings.triangles); }

// push.count: triangles and edges, in the order in which the grid has them: neighbouring threads then look into the same cells.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const uint primitive = number_of(FETCH(grid_entries, 3 * i));
  if (primitive < contact_settings.triangles) return;
  edge = primitive - contact_settings.triangles;
  const vec4 outline = FETCH(grid_entries, 3 * i + 1);
  half_edge = outline.xyz;
  away = outline.w;
  trajectory = FETCH(grid_entries, 3 * i + 2);
  ends = FETCH_UINT2(edges, edge);
  search(sweep_of(track_of(ends.x), track_of(ends.y), FETCH(rest, ends.x).w), of_edges, primitive);
}
