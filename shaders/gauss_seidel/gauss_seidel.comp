// gauss_seidel: distance constraints C = |p_a - p_b| - L by XPBD (Macklin, Mueller, Chentanez 2016, eq. 18) and Gauss-Seidel:
// a dispatch projects the links of one colour, no two of which share a particle, in place, and the next colour sees the result:
//     dlambda = -(C + a lambda) / ((w_a + w_b) / omega + a),   dp = +- w grad C dlambda,   a = alpha / h^2.
//
// A link moves both of its ends by opposite impulses along itself, so that linear and angular momentum are conserved up to rounding.
// Colouring particles instead, each moved while its neighbours stand still, needs half of the dispatches but does not conserve momentum: a
// free, unevenly stretched sheet drifted by 7 cm in a second. Every sweep takes the colours in the same order: with one sweep a substep,
// alternating the order (symmetric Gauss-Seidel) changes the map from substep to substep, and shook a hung sheet to a strain of a quarter.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_WRITE(predicted)
GATHER_UINT4(coloured_links)
READ_WRITE(uint, coloured_lambda)
READ_WRITE(Counters, counters)

// The change of a link's multiplier, which is renewed.
float change_of(ColouredLink link, float len, float weight, inout float lambda) {
  const float alpha = link.compliance * motion.inverse_h2;
  float change = motion.relaxation * (link.rest - len - alpha * lambda) / max(weight + motion.relaxation * alpha, 1e-20);
  if (link.only_pulls) change = min(change, -lambda);
  lambda += change;
  return change;
}

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  const ColouredLink link = unpack_coloured(FETCH(coloured_links, k));
  vec4 p = FETCH(predicted, link.a), q = FETCH(predicted, link.b);
  vec3 d = p.xyz - q.xyz;
  const float squared = dot(d, d);
  const bool together = squared < 1e-20;
  float lambda = 0;
  if (is_iterated && (push.flags & WEFT_FIRST_ITERATION) == 0) lambda = uintBitsToFloat(coloured_lambda[k]);
  // Ends at one place have no direction: as in stretch.comp. An end that is not finite must not spoil the other.
  if (together) {
    atomicAdd(counters[0].coincident, 1);
    d = 1e-10 * vec3(0.36, 0.48, 0.8);
  }
  if (squared < 1e20) {
    const float len = together ? 1e-10 : sqrt(squared);
    const vec3 impulse = (change_of(link, len, p.w + q.w, lambda) / len) * d;
    p.xyz += p.w * impulse;
    q.xyz -= q.w * impulse;
    predicted[link.a] = p;
    predicted[link.b] = q;
  }
  if (is_iterated) coloured_lambda[k] = floatBitsToUint(lambda);
}
