// pair_faces: narrow phase. Of the near particles and triangles, those that may meet before the next detection (pair.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT4(triangles)
READ(uvec2, near_faces)

#include "contact/pair.glsl"

float largest_difference(Track vertex, Track a, Track b, Track c) {
  const vec3 from_a = vertex.trajectory - a.trajectory, from_b = vertex.trajectory - b.trajectory,
             from_c = vertex.trajectory - c.trajectory;
  return max(max(dot(from_a, from_a), dot(from_b, from_b)), dot(from_c, from_c));
}

float distance_of(vec3 p, vec3 a, vec3 b, vec3 c) { return length(offset(closest_to_triangle(p, a, b, c), p, a, b, c)); }

// push.count: places in near_faces.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= min(push.count, detection[0].near[of_triangles])) return;
  const uvec2 pair = near_faces[i];
  const uvec4 k = uvec4(pair.x, FETCH(triangles, pair.y).xyz);
  const Track vertex = track_of(k.x), a = track_of(k.y), b = track_of(k.z), c = track_of(k.w);
  const vec4 rest_vertex = FETCH(rest, k.x), rest_a = FETCH(rest, k.y);
  const Sweep sweep = sweep_of(vertex, rest_vertex.w), its_sweep = sweep_of(a, b, c, rest_a.w);
  const float spare = spare_distance(distance_of(vertex.at, a.at, b.at, c.at), largest_difference(vertex, a, b, c), sweep, its_sweep);
  const float at_rest = distance_of(rest_vertex.xyz, rest_a.xyz, FETCH(rest, k.z).xyz, FETCH(rest, k.w).xyz);
  const float separation = rest_separation(k.x, k.y, 0.5 * (rest_vertex.w + rest_a.w), at_rest);
  if (overlap(sweep, its_sweep) && spare < separation && moves(k)) add_candidate(k, separation, false);
}
