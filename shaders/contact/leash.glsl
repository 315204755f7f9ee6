// leash: how far a particle may stray between two detections of contacts (shared.h, Detection; detect_path.comp says why).
// A detection gives every particle a straight reference path and a leash about it. Needs push.

GATHER(references)
GATHER(paths)
READ(uint, leashes)

// Where particle i is expected, so many substeps after the last detection (m).
vec3 expected_at(uint i, uint substeps) {
  const uint horizon = max(detection[0].horizon, 1);
  const float passed = float(min(substeps, horizon)) / float(horizon);
  return FETCH(references, i).xyz + passed * FETCH(paths, i).xyz;
}

// p, or the nearest place on the leash about the part of the path that a substep passes: whoever was on his leash at its start,
// at `from`, may always stop there.
vec3 on_leash(vec3 p, vec3 from, vec3 to, float leash) {
  const vec3 way = to - from;
  const vec3 passed = from + clamp(dot(p - from, way) / max(dot(way, way), 1e-30), 0, 1) * way;
  const vec3 d = p - passed;
  const float squared = dot(d, d);
  return squared > leash * leash ? passed + (leash / sqrt(squared)) * d : p;
}

// Where the substep of this age may end that was to take particle i from x to p. One whose pairs there was no room for, its leash 0, stays.
vec3 held(uint i, vec3 x, vec3 p, uint age) {
  const float leash = uintBitsToFloat(leashes[i]);
  return leash > 0 ? on_leash(p, expected_at(i, age), expected_at(i, age + 1), leash) : x;
}

// Whether a prediction leaves the constraints less than half of the reach: time to detect again.
bool strays(vec3 prediction, vec3 expected, float reach) {
  const vec3 d = prediction - expected;
  return !(4 * dot(d, d) <= reach * reach);
}
