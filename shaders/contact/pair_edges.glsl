// pair_edges: what the pass does with a pair of edges; the candidate's number, if it is one (candidate.glsl). Needs contact/pair.glsl and
// cluster_edges.

float distance_of_edges(vec3 a, vec3 b, vec3 c, vec3 d) { return length(offset(closest_of_edges(a, b, c, d), a, b, c, d)); }

uint pair_edge(uvec2 pair) {
  const uvec4 k = uvec4(FETCH(cluster_edges, pair.x).xy, FETCH(cluster_edges, pair.y).xy);
  const Track a = track_of(k.x), b = track_of(k.y), c = track_of(k.z), d = track_of(k.w);
  const vec4 rest_a = FETCH(rest, k.x), rest_b = FETCH(rest, k.y), rest_c = FETCH(rest, k.z), rest_d = FETCH(rest, k.w);
  const bool touch_at_rest = were_one(rest_a, rest_c) || were_one(rest_a, rest_d) || were_one(rest_b, rest_c) || were_one(rest_b, rest_d);
  if (touch_at_rest && same_cloth(k.x, k.z)) return WEFT_NONE;
  const float clearance = sweep_of(a, b, rest_a.w).clearance + sweep_of(c, d, rest_c.w).clearance;
  const float at_rest = distance_of_edges(rest_a.xyz, rest_b.xyz, rest_c.xyz, rest_d.xyz);
  const float separation = rest_separation(k.x, k.z, 0.5 * (rest_a.w + rest_c.w), at_rest);
  const bool meet = moves(k) && !are_tangled(k, true) && may_meet(a, b, c, d, true, separation + clearance);
  return meet ? add_candidate(k, separation, true) : WEFT_NONE;
}
