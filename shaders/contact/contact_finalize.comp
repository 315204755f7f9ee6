// contact_finalize: ends the substep of a scene with contacts. A particle takes the fraction of its step that the planes of its candidates
// allow (contact_limit), and stays within its displacement bound; then velocity, position and prediction as without contacts.
//
// It also watches the displacement bounds: where a particle is off its predicted trajectory, or its prediction is about to leave it, the
// next substep begins with a detection. The predictions of anchors are known to the anchor pass alone, which watches them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_WRITE(predicted)
READ_WRITE(uvec4, step_fractions)
READ_WRITE(uint, contact_counts)
READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)

#include "motion/update_velocity.glsl"
#include "motion/displacement_bound.glsl"

const uint kOne = 0x3f800000u;   // 1.0

// The step fraction of particle i: the least of all passes', and the fallback's where it applies. Resets its entries for the next substep.
float fraction_of(uint i) {
  if (contact_counts[i] != 0) contact_counts[i] = 0;
  const uvec4 fractions = step_fractions[i];
  if (fractions == uvec4(kOne)) return 1;
  step_fractions[i] = uvec4(kOne);
  const uint least = min(min(fractions.x, fractions.y), fractions.z);
  return uintBitsToFloat(detection[0].falls_back != 0 ? min(least, fractions.w) : least);
}

// Where the substep's step from x to p, the last iterate, ends.
vec3 allowed(uint i, vec3 x, vec3 p) {
  // Where there are candidates contact_apply has kept p within the displacement bound already, before contact_limit.
  const bool contacts = detection[0].touched.x > 0;
  const float fraction = contacts ? fraction_of(i) : 1;
  const vec3 end = contacts ? p : keep_within_bound(i, x, p, detection[0].steps);
  if (fraction < 1 || end != p) atomicAdd(counters[0].truncated, 1);
  return fraction < 1 ? x + fraction * (end - x) : end;
}

bool is_off(vec3 end, vec3 expected, float margin) {
  const vec3 off = end - expected;
  return !(dot(off, off) <= margin * margin);
}

// A displacement bound of 0, of a particle with an overflowed candidate, asks for the next detection at once. At a frame's end there is no
// prediction yet: the next frame's is watched by predict.comp.
void watch_bound(uint i, vec3 end, vec3 expected, vec3 prediction) {
  const float margin = detection[0].margin;
  const bool predicts = (push.flags & WEFT_LAST_SUBSTEP) == 0;
  const bool will_leave = predicts && strays(prediction, expected_at(i, detection[0].steps + 2), margin);
  if (will_leave || displacement_bounds[i] == 0 || is_off(end, expected, margin)) detection[0].needs_detection = 1;
}

// A kinematic particle goes to its target, or as far as contact_limit lets it: then it goes on from there in the next substep.
void move_kinematic(uint i, vec3 target, vec3 expected) {
  vec3 end = target;
  const float fraction = detection[0].touched.x > 0 ? fraction_of(i) : 1;
  if (fraction < 1) {
    const vec3 x = FETCH(positions, i).xyz;
    end = x + fraction * (target - x);
    atomicAdd(counters[0].truncated, 1);
    if (is_off(end, expected, detection[0].margin)) detection[0].needs_detection = 1;
  }
  positions[i].xyz = end;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec4 p = FETCH(predicted, i);
  const vec3 expected = expected_at(i, detection[0].steps + 1);
  if (p.w == 0) {
    move_kinematic(i, p.xyz, expected);
    return;
  }
  const vec3 x = FETCH(positions, i).xyz;
  const vec4 v = FETCH(velocities, i);
  p.xyz = allowed(i, x, p.xyz);
  const vec3 end = p.xyz;
  p = update_velocity(i, x, p, v.xyz, FETCH(materials, floatBitsToUint(v.w)).x);
  watch_bound(i, end, expected, p.xyz);
  predicted[i] = p;
}
