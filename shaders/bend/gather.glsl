// gather: every particle sums the impulses of its stencils, dp_i = sum_e w_i g_i(e) dlambda_e, which the pass before has written. The
// multipliers have been over-relaxed already, so that a converged substep solves what its compliances say.
//
// Needs IMPULSE(k), of which xyz is g dlambda or dlambda; ROW(i), the particle's first pair of uses and their number; and USES(k), a pair
// of (impulse, factor as float bits).

#include "motion/finalize.glsl"

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
  leave(i, next);
}
