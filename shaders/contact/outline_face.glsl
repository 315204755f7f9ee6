// outline_face: the outline of a triangle, about its particles' trajectories. Needs contact/final_track.glsl, contact/put_outline.glsl, rest
// and cluster_faces.

Outline outline_of_face(uvec3 t) {
  const Track a = final_track(t.x), b = final_track(t.y), c = final_track(t.z);
  const vec3 low = min(min(a.at, b.at), c.at), high = max(max(a.at, b.at), c.at);
  const vec3 trajectory = (a.trajectory + b.trajectory + c.trajectory) / 3;
  const float strays = max(max(distance(a.trajectory, trajectory), distance(b.trajectory, trajectory)), distance(c.trajectory, trajectory));
  const float thickness = FETCH(rest, t.x).w;
  return Outline(0.5 * (low + high), 0.5 * (high - low), trajectory, reach_of(strays, sweep_of(a, b, c, thickness), thickness));
}

void outline_face(uint i) {
  const uvec4 face = FETCH(cluster_faces, i);
  put_outline(i, outline_of_face(face.xyz), face.w);
}
