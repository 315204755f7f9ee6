// implicit_drift: the velocity that a solve, stopped before it has converged, gave to the centre of mass of a cloth that nothing holds.
// Springs are internal forces and cannot move it, so implicit_step takes it off again. A workgroup a cloth. Colliders can move it: a cloth
// that touches one counts as having a mass beyond all others, so that its drift is 0.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(inverses)
GATHER(collider_filters)
READ(Linear, linear)
READ_WRITE(FreeCloth, free_cloths)

#include "implicit/implicit.glsl"
#include "implicit/implicit_change.glsl"

void main() {
  const Linear state = linear[0];
  const FreeCloth cloth = free_cloths[gl_WorkGroupID.x];
  vec4 sum = vec4(0);
  for (uint k = gl_LocalInvocationID.x; k < cloth.particles; k += gl_WorkGroupSize.x) {
    const float mass = FETCH(inverses, 2 * (cloth.first + k)).w;
    sum += mass * vec4(change_of(cloth.first + k, state, push.count), 1);
    if (has_colliders && FETCH(collider_filters, 2 * (cloth.first + k)) != vec4(0, 0, 0, 1)) sum.w += 1e30;
  }
  sum = sum_of_group(sum);
  if (gl_LocalInvocationID.x == 0) free_cloths[gl_WorkGroupID.x].drift = pack(sum.w > 0 ? sum.xyz / sum.w : vec3(0));
}
