// displacement_bound: how far a particle may be from its predicted trajectory between two detections of contacts (shared.h, Detection;
// detect_trajectory.comp says why). A detection gives every particle a trajectory and a displacement bound about it. Needs push.

GATHER(detected_positions)
GATHER(trajectories)
READ(uint, displacement_bounds)

// The place of particle i on its predicted trajectory so many substeps after the last detection (m).
vec3 expected_at(uint i, uint substeps) {
  const uint lifetime = max(detection[0].lifetime, 1);
  const float passed = float(min(substeps, lifetime)) / float(lifetime);
  return FETCH(detected_positions, i).xyz + passed * FETCH(trajectories, i).xyz;
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

// p, kept within the displacement bound of particle i, `steps` substeps after the detection; x, the substep's start, if a candidate of it
// has overflowed (bound 0).
vec3 keep_within_bound(uint i, vec3 x, vec3 p, uint steps) {
  const float bound = uintBitsToFloat(displacement_bounds[i]);
  return bound > 0 ? within_bound(p, expected_at(i, steps), expected_at(i, steps + 1), bound) : x;
}

// Whether a prediction uses up so much of the detection margin that constraints might not have what they need: a detection is needed. They
// need little: asked for at a half, detections were a third more, and no fewer steps were cut short.
const float used_up = 0.9;

bool strays(vec3 prediction, vec3 expected, float margin) {
  const vec3 d = prediction - expected;
  const float most = used_up * margin;
  return !(dot(d, d) <= most * most);
}
