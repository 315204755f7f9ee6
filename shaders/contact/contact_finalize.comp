// contact_finalize: ends the substep of a scene with contacts. A particle goes the fraction of its way that no candidate's plane forbids
// (contact_limit), and no further than its leash lets it; then velocity, position and prediction as without contacts.
//
// Also watches: where a particle is not where its reference path wants it, or is about to stray, the next substep
// begins with a detection. Where an anchor goes the anchor pass alone knows, and watches.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_WRITE(predicted)
READ_WRITE(uvec4, fractions)
READ_WRITE(uint, contact_counts)
READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)

#include "motion/update_velocity.glsl"
#include "contact/leash.glsl"

const uint kWhole = 0x3f800000u;   // 1.0

// Of its way that particle i may go. Its entries are made ready for the next substep.
float fraction_of(uint i) {
  const uint fours = WEFT_ROUNDS / 4;
  uint least = kWhole, fixed_planes = kWhole;
  for (uint k = 0; k < fours; ++k) {
    uvec4 rounds = fractions[fours * i + k];
    if (rounds == uvec4(kWhole)) continue;
    fractions[fours * i + k] = uvec4(kWhole);
    if (k + 1 == fours) {
      fixed_planes = rounds.w;
      rounds.w = kWhole;
    }
    least = min(least, min(min(rounds.x, rounds.y), min(rounds.z, rounds.w)));
  }
  if (detection[0].unsafe != 0) least = min(least, fixed_planes);
  if (contact_counts[i] != 0) contact_counts[i] = 0;
  return uintBitsToFloat(least);
}

// Where the substep really takes the particle from x when the constraints took it to p.
vec3 allowed(uint i, vec3 x, vec3 p) {
  // With candidates at hand contact_apply has put it on its leash, before the planes were asked.
  const bool contacts = detection[0].touched.x > 0;
  const float fraction = contacts ? fraction_of(i) : 1;
  const vec3 end = contacts ? p : held(i, x, p, detection[0].age);
  if (fraction < 1 || end != p) atomicAdd(counters[0].truncated, 1);
  return fraction < 1 ? x + fraction * (end - x) : end;
}

bool strays_from(vec3 end, vec3 expected, float reach) {
  const vec3 off = end - expected;
  return !(dot(off, off) <= reach * reach);
}

// A particle that is held, its leash 0, waits for the next detection. At a frame's end there is no prediction yet: the next frame
// watches its own (predict.comp).
void watch(uint i, vec3 end, vec3 expected, vec3 prediction) {
  const float reach = detection[0].reach;
  const bool leaves = (push.flags & WEFT_LAST_SUBSTEP) == 0 && strays(prediction, expected_at(i, detection[0].age + 2), reach);
  if (leaves || leashes[i] == 0 || strays_from(end, expected, reach)) detection[0].due = 1;
}

// A particle that is led goes to its target, or as far as contact_limit lets it: then it goes on from there in the next substep.
void lead(uint i, vec3 target, vec3 expected) {
  vec3 end = target;
  const float fraction = detection[0].touched.x > 0 ? fraction_of(i) : 1;
  if (fraction < 1) {
    const vec3 x = FETCH(positions, i).xyz;
    end = x + fraction * (target - x);
    atomicAdd(counters[0].truncated, 1);
    if (strays_from(end, expected, detection[0].reach)) detection[0].due = 1;
  }
  positions[i].xyz = end;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec4 p = FETCH(predicted, i);
  const vec3 expected = expected_at(i, detection[0].age + 1);
  if (p.w == 0) {
    lead(i, p.xyz, expected);
    return;
  }
  const vec3 x = FETCH(positions, i).xyz;
  const vec4 v = FETCH(velocities, i);
  p.xyz = allowed(i, x, p.xyz);
  const vec3 end = p.xyz;
  p = update_velocity(i, x, p, v.xyz, FETCH(materials, floatBitsToUint(v.w)).x);
  watch(i, end, expected, p.xyz);
  predicted[i] = p;
}
