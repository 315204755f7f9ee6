// outline_edge: the outline of an edge, about its particles' trajectories. Needs contact/final_track.glsl, contact/put_outline.glsl, rest
// and cluster_edges.

Outline outline_of_edge(uvec2 e) {
  const Track a = final_track(e.x), b = final_track(e.y);
  return Outline(0.5 * (a.at + b.at), 0.5 * (b.at - a.at), 0.5 * (a.trajectory + b.trajectory),
                 reach_of(0.5 * distance(a.trajectory, b.trajectory), sweep_of(a, b, FETCH(rest, e.x).w), FETCH(rest, e.x).w));
}

void outline_edge(uint i) {
  const uvec4 e = FETCH(cluster_edges, i);
  put_outline(contact_settings.triangles + i, outline_of_edge(e.xy), e.z);
}
