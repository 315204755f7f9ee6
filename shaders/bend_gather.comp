// bend_gather: every particle sums what its bending stencils ask of it: dp_i = sum_e w_i K_i dlambda_e.
// The multipliers have been over-relaxed already, so that a converged substep solves what its compliances say.
// With HINGES: hinge_gather, which does so for hinges: dp_i = sum_e w_i grad_i dlambda_e.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
#ifdef HINGES
GATHER(hinge_impulses)
GATHER_UINT2(hinge_use_rows)
GATHER_UINT4(hinge_uses)
#define IMPULSE(k) FETCH(hinge_impulses, k)
#define ROW(i) FETCH_UINT2(hinge_use_rows, i)
#define USES(k) FETCH(hinge_uses, k)
#else
GATHER(bend_impulses)
GATHER_UINT2(bend_use_rows)
GATHER_UINT4(bend_uses)
#define IMPULSE(k) FETCH(bend_impulses, k)
#define ROW(i) FETCH_UINT2(bend_use_rows, i)
#define USES(k) FETCH(bend_uses, k)
#endif
WRITE(vec4, relaxed)
READ_WRITE(Counters, counters)

layout(push_constant, scalar) uniform Constants { Push push; };

#ifdef SETTLE
#include "settle.glsl"
#endif

vec3 share(uvec2 use) {
  return uintBitsToFloat(use.y) * IMPULSE(use.x).xyz;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 p = FETCH(predicted, i);
  const uvec2 row = ROW(i);
  const uint end = row.x + ((row.y + 1) >> 1);
  vec3 sum = vec3(0);
  for (uint k = row.x; k < end; ++k) {
    const uvec4 pair = USES(k);
    sum += share(pair.xy) + share(pair.zw);
  }
  const vec4 next = vec4(p.xyz + sum, p.w);
#ifdef SETTLE
  settle(i, next);
#else
  relaxed[i] = next;
#endif
}
