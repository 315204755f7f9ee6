// pair_faces: narrow phase. Of the near particles and triangles, those that may meet before the next detection (pair.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT4(cluster_faces)
READ(uvec2, near_faces)

#include "contact/pair.glsl"

float distance_of(vec3 p, vec3 a, vec3 b, vec3 c) { return length(offset(closest_to_triangle(p, a, b, c), p, a, b, c)); }

// push.count: places in near_faces.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= min(push.count, detection[0].near[of_triangles])) return;
  const uvec2 pair = near_faces[i];
  const uvec4 k = uvec4(pair.x, FETCH(cluster_faces, pair.y).xyz);
  const Track vertex = track_of(k.x), a = track_of(k.y), b = track_of(k.z), c = track_of(k.w);
  const vec4 rest_vertex = FETCH(rest, k.x), rest_a = FETCH(rest, k.y), rest_b = FETCH(rest, k.z), rest_c = FETCH(rest, k.w);
  if (same_cloth(k.x, k.y) && (were_one(rest_vertex, rest_a) || were_one(rest_vertex, rest_b) || were_one(rest_vertex, rest_c))) return;
  const float clearance = sweep_of(vertex, rest_vertex.w).clearance + sweep_of(a, b, c, rest_a.w).clearance;
  const float at_rest = distance_of(rest_vertex.xyz, rest_a.xyz, rest_b.xyz, rest_c.xyz);
  const float separation = rest_separation(k.x, k.y, 0.5 * (rest_vertex.w + rest_a.w), at_rest);
  if (moves(k) && !are_tangled(k, false) && may_meet(vertex, a, b, c, false, separation + clearance)) add_candidate(k, separation, false);
}
