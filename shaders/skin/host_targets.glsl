// host_targets: points of skins that are where the host's own skinning on the GPU has them (Simulation::set_targets), and not where joints
// take them. What a frame ends with is kept, so that the next one begins with it to the bit. A target that is not finite, or 1e10 m away, is
// counted; the point stays where it is. Needs push.

READ(uvec2, target_rows)
READ(uint, skin_sources)
READ(vec4, host_targets)
READ(vec4, host_normals)
READ_WRITE(vec4, skin_ends)
READ_WRITE(Counters, counters)

struct Ends {
  vec3 x_from, x_to;             // m
  vec3 normal_from, normal_to;   // unit; only with backstops
};

bool is_place(vec3 x) { return dot(x, x) < 1e20; }

vec3 normal_of_host(uint vertex, vec3 otherwise) {
  const vec3 n = host_normals[vertex].xyz;
  const float squared = dot(n, n);
  return squared > 1e-24 && squared < 1e20 ? n / sqrt(squared) : otherwise;
}

// The host's place of the point, relative to the origin; where it begins if there is none.
vec3 place_of_host(uint vertex, vec3 x_from) {
  const vec3 x = host_targets[vertex].xyz - motion.origin;
  if (is_place(x)) return x;
  atomicAdd(counters[0].non_finite, 1);
  return x_from;
}

// `ends`: where joints have the k-th point.
Ends with_host_targets(uint k, Ends ends) {
  const uint vertex = target_rows[k].x;
  if (vertex == WEFT_NONE) return ends;
  const bool has_normals = motion_constraints > 1;
  const uint source = skin_sources[target_rows[k].y], at = has_normals ? 2 * k : k;
  if ((source & WEFT_FROM_KEPT) != 0) {
    ends.x_from = skin_ends[at].xyz;
    if (has_normals) ends.normal_from = skin_ends[at + 1].xyz;
  }
  if ((source & WEFT_TO_KEPT) != 0) {
    ends.x_to = ends.x_from;
    ends.normal_to = ends.normal_from;
  }
  if ((source & WEFT_TO_HOST) != 0) {
    ends.x_to = place_of_host(vertex, ends.x_from);
    skin_ends[at] = vec4(ends.x_to, 0);
    if (has_normals) {
      if ((source & WEFT_HOST_NORMALS) != 0) ends.normal_to = normal_of_host(vertex, ends.normal_from);
      skin_ends[at + 1] = vec4(ends.normal_to, 0);
    }
  }
  return ends;
}
