// search_either: what a thread does that searches for triangles or for edges. Needs contact/own_search.glsl.

// i: of particles and edges, in this order.
void search_either(uint i) {
  const uint cluster = begin_search(i), kind = is_edge ? of_edges : of_triangles;
  search(kind, cluster, !is_edge, false);
  end_search(kind);
  if (overflowed != 0) search(kind, cluster, !is_edge, true);
}
