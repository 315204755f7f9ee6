// pair: narrow phase. Of the near pairs, those that may meet before the next detection (pair.glsl). A row of workgroups for each kind: of
// particles and triangles, and of edges.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT4(cluster_faces)
GATHER_UINT4(cluster_edges)
READ(uvec2, near_faces)
READ(uvec2, near_edges)

#include "contact/pair.glsl"

float distance_to_triangle(vec3 p, vec3 a, vec3 b, vec3 c) { return length(offset(closest_to_triangle(p, a, b, c), p, a, b, c)); }
float distance_of_edges(vec3 a, vec3 b, vec3 c, vec3 d) { return length(offset(closest_of_edges(a, b, c, d), a, b, c, d)); }

void judge_face(uvec2 pair) {
  const uvec4 k = uvec4(pair.x, FETCH(cluster_faces, pair.y).xyz);
  const Track vertex = track_of(k.x), a = track_of(k.y), b = track_of(k.z), c = track_of(k.w);
  const vec4 rest_vertex = FETCH(rest, k.x), rest_a = FETCH(rest, k.y), rest_b = FETCH(rest, k.z), rest_c = FETCH(rest, k.w);
  if (same_cloth(k.x, k.y) && (were_one(rest_vertex, rest_a) || were_one(rest_vertex, rest_b) || were_one(rest_vertex, rest_c))) return;
  const float clearance = sweep_of(vertex, rest_vertex.w).clearance + sweep_of(a, b, c, rest_a.w).clearance;
  const float at_rest = distance_to_triangle(rest_vertex.xyz, rest_a.xyz, rest_b.xyz, rest_c.xyz);
  const float separation = rest_separation(k.x, k.y, 0.5 * (rest_vertex.w + rest_a.w), at_rest);
  if (moves(k) && !are_tangled(k, false) && may_meet(vertex, a, b, c, false, separation + clearance)) add_candidate(k, separation, false);
}

void judge_edges(uvec2 pair) {
  const uvec4 k = uvec4(FETCH(cluster_edges, pair.x).xy, FETCH(cluster_edges, pair.y).xy);
  const Track a = track_of(k.x), b = track_of(k.y), c = track_of(k.z), d = track_of(k.w);
  const vec4 rest_a = FETCH(rest, k.x), rest_b = FETCH(rest, k.y), rest_c = FETCH(rest, k.z), rest_d = FETCH(rest, k.w);
  const bool touch_at_rest = were_one(rest_a, rest_c) || were_one(rest_a, rest_d) || were_one(rest_b, rest_c) || were_one(rest_b, rest_d);
  if (touch_at_rest && same_cloth(k.x, k.z)) return;
  const float clearance = sweep_of(a, b, rest_a.w).clearance + sweep_of(c, d, rest_c.w).clearance;
  const float at_rest = distance_of_edges(rest_a.xyz, rest_b.xyz, rest_c.xyz, rest_d.xyz);
  const float separation = rest_separation(k.x, k.z, 0.5 * (rest_a.w + rest_c.w), at_rest);
  if (moves(k) && !are_tangled(k, true) && may_meet(a, b, c, d, true, separation + clearance)) add_candidate(k, separation, true);
}

// push.count: places in near_faces, and in near_edges. Loops of one turn: the software driver runs through both sides of a branch.
void main() {
  const uint i = gl_GlobalInvocationID.x, kind = gl_WorkGroupID.y;
  const bool is_pair = i < min(push.count, detection[0].near[kind]);
  for (bool turn = is_pair && kind == of_triangles; turn; turn = false) judge_face(near_faces[i]);
  for (bool turn = is_pair && kind == of_edges; turn; turn = false) judge_edges(near_edges[i]);
}
