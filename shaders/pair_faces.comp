// pair_faces: every particle looks for the triangles that it may meet before the next detection (pair.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT4(triangles)

layout(push_constant, scalar) uniform Constants { Push push; };

#include "pair.glsl"

uint vertex;
Track track;
Sweep sweep;
float thickness;

float distance_of(vec3 p, vec3 a, vec3 b, vec3 c) { return length(offset(closest_to_triangle(p, a, b, c), p, a, b, c)); }

float rest_distance(uvec4 t) {
  return distance_of(FETCH(rest, vertex).xyz, FETCH(rest, t.x).xyz, FETCH(rest, t.y).xyz, FETCH(rest, t.z).xyz);
}

bool moves(uvec4 t) {
  return inverse_mass(vertex) > 0 || inverse_mass(t.x) > 0 || inverse_mass(t.y) > 0 || inverse_mass(t.z) > 0;
}

bool may_reach(vec3 m, uint third) { return true; }

void meet(uint face) {
  const uvec4 t = FETCH(triangles, face);
  if (any(equal(t.xyz, uvec3(vertex)))) return;
  const Track a = track_of(t.x), b = track_of(t.y), c = track_of(t.z);
  const float its_thickness = FETCH(rest, t.x).w;
  const Sweep its_sweep = sweep_of(a, b, c, its_thickness);
  if (!overlap(sweep, its_sweep)) return;
  const vec3 from_a = track.path - a.path, from_b = track.path - b.path, from_c = track.path - c.path;
  const float relative = max(max(dot(from_a, from_a), dot(from_b, from_b)), dot(from_c, from_c));
  const float spare = spare_distance(distance_of(track.at, a.at, b.at, c.at), relative, sweep, its_sweep);
  float keep = 0.5 * (thickness + its_thickness);
  if (spare >= keep || !moves(t)) return;
  if (same_cloth(vertex, t.x)) keep = min(keep, share_of_rest * rest_distance(t));
  if (spare < keep) add_candidate(uvec4(vertex, t.xyz), keep, false);
}

// push.count: particles.
void main() {
  vertex = gl_GlobalInvocationID.x;
  if (vertex >= push.count) return;
  track = track_of(vertex);
  thickness = FETCH(rest, vertex).w;
  sweep = sweep_of(track, thickness);
  search(sweep, of_triangles, WEFT_NONE);
}
