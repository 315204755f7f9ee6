// start_track: what detect_track does for particle i. Needs contact/grid.glsl, positions, predicted, detected_positions, trajectories and
// near_bounds.

const float most_cells = 32;   // a substep

// How much larger a bound is than the last motion asks for, as the next is another; what a calmer particle keeps of its last bound; and
// what it takes over from its cluster, as waves run.
// Measured (drop of 100 x 100) without the last: 1.25 and 0.7 need twice the detections, 2 and 0.95 twice the candidates.
const float spare = 1.6, kept = 0.85, spread = 0.5;

vec3 trajectory_along(vec3 d) {
  const float longest = most_cells * contact_settings.cell;
  const float squared = dot(d, d);
  if (!(squared < 1e20)) return vec3(0);   // not finite: it will be put back (update_velocity.glsl)
  return (squared > longest * longest ? longest / sqrt(squared) : 1) * float(detection[0].lifetime) * d;
}

float sum_to(uint n) { return 0.5 * float(n * (n + 1)); }

// p: where the particle is about to go.
float bound_of(uint i, vec3 p) {
  const float most = detection[0].margin;
  const uint passed = detection[0].served + 1, lifetime = detection[0].served_lifetime;
  const vec4 at = LATEST(detected_positions, i);
  if (lifetime == 0) return clamp(at.w, detection[0].least, most);   // the first detection, or the first after the host has put particles
  const vec3 expected = at.xyz + float(min(passed, lifetime)) / float(lifetime) * LATEST(trajectories, i).xyz;
  const float own = spare * distance(p, expected) * (sum_to(detection[0].horizon) / sum_to(passed));
  const float near = spread * uintBitsToFloat(LATEST_UINT(near_bounds, i));
  return own < most ? clamp(max(own, max(kept * at.w, near)), detection[0].least, most) : most;
}

void start_track(uint i) {
  const vec3 x = FETCH(positions, i).xyz, p = FETCH(predicted, i).xyz;
  const float bound = bound_of(i, p);
  detected_positions[i] = vec4(x, bound);
  trajectories[i].xyz = trajectory_along(p - x);
}
