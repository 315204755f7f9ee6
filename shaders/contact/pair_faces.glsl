// pair_faces: what the pass does with a pair of a particle and a triangle; the candidate's number, if it is one (candidate.glsl). Needs
// contact/pair.glsl and cluster_faces.

float distance_to_face(vec3 p, vec3 a, vec3 b, vec3 c) { return length(offset(closest_to_triangle(p, a, b, c), p, a, b, c)); }

uint pair_face(uvec2 pair) {
  const uvec4 k = uvec4(pair.x, FETCH(cluster_faces, pair.y).xyz);
  const Track vertex = track_of(k.x), a = track_of(k.y), b = track_of(k.z), c = track_of(k.w);
  const vec4 rest_vertex = FETCH(rest, k.x), rest_a = FETCH(rest, k.y), rest_b = FETCH(rest, k.z), rest_c = FETCH(rest, k.w);
  if (same_cloth(k.x, k.y) && (were_one(rest_vertex, rest_a) || were_one(rest_vertex, rest_b) || were_one(rest_vertex, rest_c)))
    return WEFT_NONE;
  const float clearance = sweep_of(vertex, rest_vertex.w).clearance + sweep_of(a, b, c, rest_a.w).clearance;
  const float at_rest = distance_to_face(rest_vertex.xyz, rest_a.xyz, rest_b.xyz, rest_c.xyz);
  const float separation = rest_separation(k.x, k.y, 0.5 * (rest_vertex.w + rest_a.w), at_rest);
  const bool meet = moves(k) && !are_tangled(k, false) && may_meet(vertex, a, b, c, false, separation + clearance);
  return meet ? add_candidate(k, separation, false) : WEFT_NONE;
}
