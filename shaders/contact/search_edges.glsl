// search_edges: how an edge searches for the edges that come after it. Needs contact/search.glsl, contact/mask.glsl and the buffers.

uint edge, own_cluster;
uvec2 ends;

// Separating axis m: the gap along m is |m| less the half extents of both edges along it. In a flat sheet that rejects all but the nearest
// edges, which boxes do not.
bool edge_may_meet(Outline other, vec3 m, vec3 relative, float reach) {
  const float squared = dot(m, m);
  const float stopped = max(abs(dot(m, own.trajectory)), abs(dot(m, other.trajectory))) * part_of_lifetime;
  const float halves = abs(dot(m, own.half_sides)) + abs(dot(m, other.half_sides));
  return squared * (1 - 4 * rounding) <= halves + abs(dot(m, relative)) + stopped + sqrt(squared) * reach;
}

uvec2 edges_of(uint cluster) {
  return uvec2(cluster == own_cluster ? edge + 1 : FETCH(clusters, cluster).y, FETCH(clusters, cluster + 1).y);
}

uint number_of_edge(uint member) { return contact_settings.triangles + member; }

bool can_pair_with_edge(uint member, out uvec4 particles) {
  const uvec2 e = FETCH(cluster_edges, member).xy;
  particles = uvec4(ends, e);
  bool can = ends.x != e.x && ends.x != e.y && ends.y != e.x && ends.y != e.y;
  if (contact_mask_words > 0) can = can && meets_other(ends.x, e.x);
  return can;
}

// Edge i becomes the thread's own.
void searching_edge(uint i) {
  edge = i;
  const uvec4 e = FETCH(cluster_edges, edge);
  ends = e.xy;
  own_cluster = e.z;
  own = outline_at(number_of_edge(edge));
  part_of_lifetime = per_substep();
}
