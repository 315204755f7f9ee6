// pair_edges: every edge looks for the edges that it may meet before the next detection (pair.glsl). Of a pair the edge on the
// lower level finds the other; for two on one level see Search.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT2(edges)

layout(push_constant, scalar) uniform Constants { Push push; };

#include "pair.glsl"

uint edge;
uvec2 ends;
Track tracks[2];
Sweep sweep;
vec4 rod;
float thickness;

float distance_of(vec3 a, vec3 b, vec3 c, vec3 d) { return length(offset(closest_of_edges(a, b, c, d), a, b, c, d)); }

float rest_distance(uvec2 e) {
  return distance_of(FETCH(rest, ends.x).xyz, FETCH(rest, ends.y).xyz, FETCH(rest, e.x).xyz, FETCH(rest, e.y).xyz);
}

bool moves(uvec2 e) {
  return inverse_mass(ends.x) > 0 || inverse_mass(ends.y) > 0 || inverse_mass(e.x) > 0 || inverse_mass(e.y) > 0;
}

float squared_difference(Track a, Track b) {
  const vec3 d = a.path - b.path;
  return dot(d, d);
}

// Between planes across m there is at least |m| less what both edges extend along it. In a flat sheet that tells all but
// the nearest apart, which boxes do not.
bool may_reach(vec3 m, uint third) {
  const vec4 other = FETCH(grid_entries, third);
  const float squared = dot(m, m);
  return squared <= abs(dot(m, rod.xyz)) + abs(dot(m, other.xyz)) + (1 + rounding) * sqrt(squared) * (rod.w + other.w);
}

void meet(uint primitive) {
  const uint other = primitive - push.triangles;
  const uvec2 e = FETCH_UINT2(edges, other);
  if (ends.x == e.x || ends.x == e.y || ends.y == e.x || ends.y == e.y) return;
  const Track a = track_of(e.x), b = track_of(e.y);
  const float its_thickness = FETCH(rest, e.x).w;
  const Sweep its_sweep = sweep_of(a, b, its_thickness);
  if (!overlap(sweep, its_sweep)) return;
  const float relative = max(max(squared_difference(tracks[0], a), squared_difference(tracks[0], b)), max(squared_difference(tracks[1], a), squared_difference(tracks[1], b)));
  const float spare = spare_distance(distance_of(tracks[0].at, tracks[1].at, a.at, b.at), relative, sweep, its_sweep);
  float keep = 0.5 * (thickness + its_thickness);
  if (spare >= keep || !moves(e)) return;
  if (same_cloth(ends.x, e.x)) keep = min(keep, share_of_rest * rest_distance(e));
  if (spare < keep) add_candidate(uvec4(ends, e), keep, true);
}

// push.count: triangles and edges, in the order in which the grid has them: neighbouring threads then look into the same cells.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const uint primitive = number_of(FETCH(grid_entries, 3 * i));
  if (primitive < push.triangles) return;
  edge = primitive - push.triangles;
  rod = FETCH(grid_entries, 3 * i + 2);
  ends = FETCH_UINT2(edges, edge);
  tracks = Track[2](track_of(ends.x), track_of(ends.y));
  thickness = FETCH(rest, ends.x).w;
  sweep = sweep_of(tracks[0], tracks[1], thickness);
  search(sweep, of_edges, push.triangles + edge);
}
