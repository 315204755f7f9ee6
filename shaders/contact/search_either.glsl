// search_either: how a thread searches for triangles or for edges. Needs contact/search_faces.glsl and contact/search_edges.glsl.

bool is_edge;

bool may_meet(Outline other, vec3 m, vec3 relative, float reach) {
  return is_edge ? edge_may_meet(other, m, relative, reach) : face_may_meet(other, m, relative, reach);
}
uvec2 members_of(uint cluster) { return is_edge ? edges_of(cluster) : faces_of(cluster); }
uint outline_number(uint member) { return is_edge ? number_of_edge(member) : member; }
bool can_be_pair(uint member, out uvec4 particles) {
  return is_edge ? can_pair_with_edge(member, particles) : can_pair_with_face(member, particles);
}

// i: of particles and edges, in this order.
void search_either(uint i) {
  is_edge = i >= contact_settings.particles;
  uint cluster;
  if (is_edge) {
    searching_edge(i - contact_settings.particles);
    cluster = own_cluster;
  } else {
    cluster = searching_particle(i);
  }
  const uint kind = is_edge ? of_edges : of_triangles;
  search(kind, cluster, !is_edge, false);
  end_search(kind, cluster, !is_edge);
}
