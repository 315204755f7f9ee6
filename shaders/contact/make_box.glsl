// make_box: what cluster_box does for a cluster. Needs contact/grid.glsl, contact/cluster.glsl, contact/predicted_track.glsl and the buffers.

// Boxes are made before it is known who is pushed (grid_search), so large enough for all.
Track widest_track(uint i) { return predicted_track(i, detection[0].most_pushed); }

// Deformation gradients of a triangle where trajectories begin and where they end: of the rest pose's directions; 0 across it.
struct Gradients {
  mat3 first, last;
  float slope;   // 1/m: the largest of the three barycentric coordinates' gradients at rest
};

Gradients gradients_of(uvec3 t) {
  const vec3 at = FETCH(rest, t.x).xyz, a = FETCH(rest, t.y).xyz - at, b = FETCH(rest, t.z).xyz - at;
  const float aa = dot(a, a), ab = dot(a, b), bb = dot(b, b);
  const float inverse = 1 / (aa * bb - ab * ab);
  const vec3 of_y = inverse * (bb * a - ab * b), of_z = inverse * (aa * b - ab * a);   // of barycentric coordinates
  const Track x = widest_track(t.x), y = widest_track(t.y), z = widest_track(t.z);
  const mat3 first = outerProduct(y.at - x.at, of_y) + outerProduct(z.at - x.at, of_z);
  const mat3 change = outerProduct(y.trajectory - x.trajectory, of_y) + outerProduct(z.trajectory - x.trajectory, of_z);
  return Gradients(first, first + change, max(length(of_y + of_z), max(length(of_y), length(of_z))));
}

float norm_of(mat3 m) { return sqrt(dot(m[0], m[0]) + dot(m[1], m[1]) + dot(m[2], m[2])); }

// The unit normal of the mean of both ends. t: a triangle, which tells the plane of the rest pose.
vec3 normal_of(Gradients mean, uvec3 t) {
  const vec3 at = FETCH(rest, t.x).xyz, a = FETCH(rest, t.y).xyz - at, b = FETCH(rest, t.z).xyz - at;
  const mat3 sum = mean.first + mean.last;
  const vec3 across = cross(sum * a, sum * b);
  return across / max(length(across), 1e-30);
}

// The mean of its triangles' gradients, how far one of them is from that, and how far particles may be from their trajectories; `bound`: the
// largest (m).
void write_motion(uint cluster, Box box, vec3 trajectory, float strays, float bound, bool kinematic) {
  const uint first = FETCH(clusters, cluster).x, end = FETCH(clusters, cluster + 1).x;
  Gradients mean = Gradients(mat3(0), mat3(0), 0);
  for (uint k = first; k < end; ++k) {
    const Gradients own = gradients_of(FETCH(cluster_faces, k).xyz);
    mean.first += own.first;
    mean.last += own.last;
    mean.slope = max(mean.slope, own.slope);
  }
  const float share = 1 / max(float(end - first), 1);
  mean.first *= share;
  mean.last *= share;
  const vec3 normal = normal_of(mean, FETCH(cluster_faces, first).xyz);
  vec2 off = vec2(0);
  for (uint k = first; k < end; ++k) {
    const Gradients own = gradients_of(FETCH(cluster_faces, k).xyz);
    const mat3 of_first = own.first - mean.first, of_last = own.last - mean.last;
    const vec2 across = vec2(length(normal * of_first), length(normal * of_last)), whole = vec2(norm_of(of_first), norm_of(of_last));
    off.x = max(off.x, sqrt(max(0, max(whole.x * whole.x - across.x * across.x, whole.y * whole.y - across.y * across.y))));
    off.y = max(off.y, max(across.x, across.y));
  }
  const vec3 far = max(abs(box.low), abs(box.high));
  const float clearance = bound + rounding * max(far.x, max(far.y, far.z));
  const uint row = WEFT_MOTION * cluster;
  cluster_motions[row] = vec4(mean.first[0], off.x);
  cluster_motions[row + 1] = vec4(mean.first[1], mean.slope);
  cluster_motions[row + 2] = vec4(mean.first[2], clearance);
  for (int k = 0; k < 3; ++k) cluster_motions[row + 3 + k] = vec4(mean.last[k], normal[k]);
  cluster_motions[row + 6] = vec4(trajectory, strays);
  cluster_motions[row + 7] = vec4(off.y, kinematic ? 1 : 0, 0, 0);
}

void make_box(uint cluster) {
  Box box = Box(vec3(1e30), vec3(-1e30)), ways = box;
  bool kinematic = false;
  float bound = 0;   // that particles' own motion asked for, the largest
  const uint end = FETCH(clusters, cluster + 1).z;
  for (uint k = FETCH(clusters, cluster).z; k < end; ++k) {
    const uint i = FETCH_UINT(cluster_hulls, k);
    const Track track = widest_track(i);
    const Sweep sweep = sweep_of(track, FETCH(rest, i).w);
    box = Box(min(box.low, sweep.low), max(box.high, sweep.high));
    bound = max(bound, LATEST(detected_positions, i).w);
    kinematic = kinematic || FETCH(positions, i).w == 0;
    ways = Box(min(ways.low, track.trajectory), max(ways.high, track.trajectory));
  }
  for (uint k = FETCH(clusters, cluster).z; k < end; ++k) {
    const uint i = FETCH_UINT(cluster_hulls, k);
    if (FETCH_UINT(memberships, FETCH_UINT(memberships, i)) == cluster) near_bounds[i] = floatBitsToUint(bound);
  }
  cluster_boxes[2 * cluster] = vec4(box.low, 0);
  cluster_boxes[2 * cluster + 1] = vec4(box.high, 0);
  near_clusters[(WEFT_NEAR_CLUSTERS + 1) * cluster] = 0;   // its list begins empty (grid_search)
  cluster_pushes[cluster] = 0;
  write_motion(cluster, box, 0.5 * (ways.low + ways.high), 0.5 * distance(ways.low, ways.high), bound + detection[0].most_pushed, kinematic);
}
