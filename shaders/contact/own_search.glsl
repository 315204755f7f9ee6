// own_search: how a thread searches for triangles or for edges. Needs contact/search_faces.glsl and contact/search_edges.glsl.

bool is_edge;

bool may_meet(Outline other, vec3 m, vec3 relative, float reach) {
  return is_edge ? edge_may_meet(other, m, relative, reach) : face_may_meet(other, m, relative, reach);
}
uvec2 members_of(uint cluster) { return is_edge ? edges_of(cluster) : faces_of(cluster); }
uint outline_number(uint member) { return is_edge ? number_of_edge(member) : member; }
bool can_be_pair(uint member, out uvec4 particles) {
  return is_edge ? can_pair_with_edge(member, particles) : can_pair_with_face(member, particles);
}

// Particle or edge i, in this order, becomes the thread's own. Its cluster.
uint begin_search(uint i) {
  is_edge = i >= contact_settings.particles;
  if (!is_edge) return searching_particle(i);
  searching_edge(i - contact_settings.particles);
  return own_cluster;
}
