// outline_one: what detect_outline does for one of its elements. Needs contact/grid.glsl, contact/predicted_track.glsl, contact/outline.glsl,
// contact/cluster.glsl, contact/outline_box.glsl, contact/near_list.glsl and the buffers.

float pushed(uint i) {
  return detection[0].most_pushed == 0 ? 0 : uintBitsToFloat(LATEST_UINT(cluster_pushes, FETCH_UINT(cluster_owners, i)));
}

Track final_track(uint i) { return predicted_track(i, pushed(i)); }

// Nobody else reads the trajectory's w in this pass.
void start_particle(uint i) {
  const Track track = final_track(i);
  trajectories[i].w = track.bound;
  displacement_bounds[i] = floatBitsToUint(track.bound);
}

Outline outline_of_edge(uvec2 e) {
  const Track a = final_track(e.x), b = final_track(e.y);
  return Outline(0.5 * (a.at + b.at), 0.5 * (b.at - a.at), 0.5 * (a.trajectory + b.trajectory),
                 reach_of(0.5 * distance(a.trajectory, b.trajectory), sweep_of(a, b, FETCH(rest, e.x).w), FETCH(rest, e.x).w));
}

Outline outline_of_face(uvec3 t) {
  const Track a = final_track(t.x), b = final_track(t.y), c = final_track(t.z);
  const vec3 low = min(min(a.at, b.at), c.at), high = max(max(a.at, b.at), c.at);
  const vec3 trajectory = (a.trajectory + b.trajectory + c.trajectory) / 3;
  const float strays = max(max(distance(a.trajectory, trajectory), distance(b.trajectory, trajectory)), distance(c.trajectory, trajectory));
  const float thickness = FETCH(rest, t.x).w;
  return Outline(0.5 * (low + high), 0.5 * (high - low), trajectory, reach_of(strays, sweep_of(a, b, c, thickness), thickness));
}

// Of its list, in place (near_list.glsl).
void put_in_order(uint cluster) {
  const uint row = row_of(cluster), listed = near_clusters[row];
  if (listed > WEFT_NEAR_CLUSTERS) {
    near_clusters[row] = WEFT_NEAR_CLUSTERS + 1;
    return;
  }
  const bool is_smooth = LATEST_UINT(smooth_clusters, cluster) != 0;
  uint count = 0, later = 0;
  for (uint k = 0; k < listed; ++k) {
    const uint entry = near_clusters[row + 1 + k], other = entry & ~WEFT_TOUCHING;
    if (other != entry && (is_smooth || LATEST_UINT(smooth_clusters, other) != 0)) continue;
    uint place = count++;
    if (other >= cluster) {   // in place of the first that does not, which goes to the end
      near_clusters[row + 1 + place] = near_clusters[row + 1 + later];
      place = later++;
    }
    near_clusters[row + 1 + place] = other;
  }
  near_clusters[row] = head_of(count, later);
}

// i: of particles, triangles, edges and clusters, in this order.
void outline_one(uint i) {
  if (i < contact_settings.particles) {
    start_particle(i);
    return;
  }
  i -= contact_settings.particles;
  const uint primitives = contact_settings.triangles + contact_settings.edges;
  if (i >= primitives) {
    put_in_order(i - primitives);
    return;
  }
  Outline outline;
  uint cluster;
  if (i < contact_settings.triangles) {
    const uvec4 face = FETCH(cluster_faces, i);
    outline = outline_of_face(face.xyz);
    cluster = face.w;
  } else {
    const uvec4 e = FETCH(cluster_edges, i - contact_settings.triangles);
    outline = outline_of_edge(e.xy);
    cluster = e.z;
  }
  const Box box = box_of(outline), of_cluster = Box(LATEST(cluster_boxes, 2 * cluster).xyz, LATEST(cluster_boxes, 2 * cluster + 1).xyz);
  outline_boxes[i] = uvec4(grains_below(of_cluster, box.low) | grains_above(of_cluster, box.high) << 16, 0);
  outlines[3 * i] = vec4(outline.middle, outline.reach);
  outlines[3 * i + 1] = vec4(outline.half_sides, 0);
  outlines[3 * i + 2] = vec4(outline.trajectory, 0);
}
