// implicit_relax: an iteration of damped block Jacobi, dv <- dv + w D^-1 (b - A dv), in gather form: every particle reads the
// last iterate and writes its own part of the next.
//
//   k = 0   line search: reads the guess, sums b . guess, guess . A guess and b . D^-1 b, and writes no iterate; the first one is
//           the guess times the best step length (engine/reference/implicit.h)
//   k > 0   reads one of three iterates and writes into the k-th modulo 3
//
// In the norm r . D^-1 r the residual falls in every iteration if Jacobi converges. Where it has grown the solve stops with the iterate
// before, which is why there are three.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT2(spring_rows)
GATHER_UINT4(spring_ends)
GATHER(spring_blocks)
GATHER(inverses)
GATHER(solve_vectors)
GATHER_WRITE(exchanged)
SHARE(vec4, partial_sums)
SHARE(Linear, linear)

#include "implicit/implicit_sum.glsl"
#include "implicit/implicit_row.glsl"

// A kinematic particle has no mass, and stays.
vec4 relax(uint i, uint k) {
  const uint from = k == 0 ? 0 : linear[0].iterate * push.count;
  const float scale = k == 0 ? 0 : linear[0].next;
  const vec4 first = FETCH(inverses, 2 * i);
  const vec3 stored = FETCH(exchanged, from + i).xyz;
  const vec3 b = FETCH(solve_vectors, i).xyz;
  vec3 product = vec3(0);
  if (first.w > 0) product = filtered(i, first.w * stored + pulls(i, stored, from));
  const Inverse inverse = Inverse(first.xyz, FETCH(inverses, 2 * i + 1).xyz);
  const vec3 r = b - scale * product;
  const vec3 half_way = half_preconditioned(inverse, r);
  if (k > 0) exchanged[(k % 3) * push.count + i] = vec4(scale * stored + motion.relaxation * preconditioned(inverse, r), 0);
  return vec4(dot(b, stored), dot(stored, product), dot(half_way, half_way), 0);
}

// The residual is that of the iterate that iteration k read.
Linear next_state(Linear now, vec4 sums, uint k) {
  if (k == 0) {
    const float step = sums.y > 0 ? sums.x / sums.y : 0;
    return Linear(sums.z, sums.z, 0, step, step, 0, 0, 0);
  }
  now.arrived = 0;
  const bool grown = k > 1 && !(sums.z <= now.squared);
  now.iterate = (grown ? k - 2 : k) % 3;
  now.next = grown && k == 2 ? now.step : 1;
  if (grown) now.done = 2;
  else now.squared = sums.z;
  return now;
}

void main() {
  const uint i = gl_GlobalInvocationID.x, k = push.iteration;
  if (k > 0 && linear[0].done != 0) return;   // all threads alike
  vec4 sums;
  if (sum_of_all(i < push.count ? relax(i, k) : vec4(0), sums)) linear[0] = next_state(linear[0], sums, k);
}
