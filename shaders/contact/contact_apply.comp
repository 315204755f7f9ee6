// contact_apply: moves each particle by the sum of its contacts' corrections [and out of colliders]. The last iteration also keeps it
// within its displacement bound, on which detection relies (displacement_bound.glsl). A bound of 0 means that a candidate of this particle
// has overflowed: it stays where the substep began.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_WRITE(predicted)
READ(Detection, detection)
READ_WRITE(ivec4, contact_sums)
READ_WRITE(uint, contact_penetrations)
READ_WRITE(Counters, counters)
READ(vec4, ways_out)

GATHER(velocities)
GATHER(materials)
#include "collide/colliders.glsl"
#include "motion/displacement_bound.glsl"

vec3 moved_by_contacts(uint i, vec3 p) {
  if (contact_penetrations[i] != 0) contact_penetrations[i] = 0;
  const ivec3 sum = contact_sums[i].xyz;
  if (sum == ivec3(0)) return p;
  contact_sums[i].xyz = ivec3(0);
  return p + contact_settings.quantum * vec3(sum);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 before = FETCH(predicted, i);
  if (before.w == 0) return;
  vec3 p = moved_by_contacts(i, before.xyz);
  if (has_colliders) {
    const vec3 start = FETCH(positions, i).xyz + (triangles_collide > 0 ? ways_out[i].xyz : vec3(0));   // as in finalize.glsl
    p = out_of_colliders(start, p, FETCH(materials, floatBitsToUint(FETCH(velocities, i).w)));
  }
  if ((push.flags & WEFT_LAST_ITERATION) != 0) {
    const vec3 end = keep_within_bound(i, FETCH(positions, i).xyz, p, detection[0].steps);
    if (end != p) atomicAdd(counters[0].truncated, 1);
    p = end;
  }
  if (p != before.xyz) predicted[i].xyz = p;
}
