// search_faces: how a particle searches for triangles. Needs contact/search.glsl, contact/mask.glsl and the buffers.

uint vertex;

bool face_may_meet(Outline other, vec3 m, vec3 relative, float reach) {
  const vec3 stopped = max(abs(own.trajectory), abs(other.trajectory)) * part_of_lifetime;
  return all(lessThanEqual(abs(m) * (1 - 4 * rounding), other.half_sides + abs(relative) + stopped + reach));
}

uvec2 faces_of(uint cluster) { return uvec2(FETCH(clusters, cluster).x, FETCH(clusters, cluster + 1).x); }

bool can_pair_with_face(uint member, out uvec4 particles) {
  const uvec3 t = FETCH(cluster_faces, member).xyz;
  particles = uvec4(vertex, t);
  bool can = !any(equal(t, uvec3(vertex)));
  if (contact_mask_words > 0) can = can && meets_other(vertex, t.x);
  return can;
}

// The cluster of searcher i, which becomes the thread's own.
uint searching_particle(uint i) {
  const uvec2 searcher = FETCH_UINT2(cluster_searchers, i);
  vertex = searcher.x;
  const Track track = track_of(vertex);
  const float thickness = FETCH(rest, vertex).w;
  own = Outline(track.at, vec3(0), track.trajectory, reach_of(0, sweep_of(track, thickness), thickness));
  part_of_lifetime = per_substep();
  return searcher.y;
}
