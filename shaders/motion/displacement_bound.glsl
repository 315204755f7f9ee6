// displacement_bound: how far a particle may be from its predicted trajectory between two detections of contacts (shared.h, Detection;
// detect_track.comp says why). A detection gives every particle a trajectory and a displacement bound about it. Needs push.

GATHER(detected_positions)
GATHER(trajectories)
GATHER_UINT(displacement_bounds)

float bound_of(uint i) { return uintBitsToFloat(FETCH_UINT(displacement_bounds, i) & ~WEFT_PAIRED); }

// Whether the last detection has found candidates of particle i.
bool is_paired(uint i) { return (FETCH_UINT(displacement_bounds, i) & WEFT_PAIRED) != 0; }

// Places of a particle on its predicted trajectory (m).
struct Expected {
  vec3 before, now, next;   // where the substep begins, where it ends, and where the next one does
};

// Of particle i, in a substep `steps` substeps after the last detection. All that it needs is read once.
Expected expected_of(uint i, uint steps) {
  const vec3 at = FETCH(detected_positions, i).xyz, trajectory = FETCH(trajectories, i).xyz;
  const uint lifetime = max(detection[0].lifetime, 1);
  const vec3 passed = vec3(min(uvec3(steps, steps + 1, steps + 2), lifetime)) / float(lifetime);
  return Expected(at + passed.x * trajectory, at + passed.y * trajectory, at + passed.z * trajectory);
}

// p, if it is within the bound of the part of the trajectory that belongs to this substep, or else the nearest point that is. A particle
// that was within its bound at the substep's start, about `from`, may therefore always stop there.
vec3 within_bound(vec3 p, vec3 from, vec3 to, float bound) {
  const vec3 along = to - from;
  const vec3 passed = from + clamp(dot(p - from, along) / max(dot(along, along), 1e-30), 0, 1) * along;
  const vec3 d = p - passed;
  const float squared = dot(d, d);
  return squared > bound * bound ? passed + (bound / sqrt(squared)) * d : p;
}

// p, kept within the displacement bound; x, the substep's start, if a candidate of the particle has overflowed (bound 0).
vec3 keep_within_bound(float bound, Expected expected, vec3 x, vec3 p) {
  return bound > 0 ? within_bound(p, expected.before, expected.now, bound) : x;
}

// Whether a prediction uses up so much of its bound that constraints might not have what they need: a detection is needed. They
// need little: asked for at a half, detections were a third more, and no fewer steps were cut short.
const float used_up = 0.9;

bool strays(vec3 prediction, vec3 expected, float bound) {
  const vec3 d = prediction - expected;
  const float most = used_up * bound;
  return !(dot(d, d) <= most * most);
}
