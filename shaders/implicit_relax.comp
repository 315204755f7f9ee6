// implicit_relax: an iteration of damped block Jacobi, dv <- dv + w D^-1 (b - A dv), in gather form: every particle reads the
// last iterate and writes its own part of the next. How iterates take turns and are watched: implicit_jacobi.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT2(spring_rows)
GATHER_UINT4(spring_ends)
GATHER(spring_blocks)
GATHER(inverses)
GATHER(krylov)
GATHER_WRITE(exchanged)
READ_WRITE(vec4, partial_sums)
READ_WRITE(Linear, linear)

layout(push_constant, scalar) uniform Constants { Push push; };

#define SUMS
#include "implicit.glsl"
#include "implicit_jacobi.glsl"
#include "implicit_row.glsl"

// Sums for the dispatch that follows. A held particle has no mass, and stays.
vec4 relax(uint i, Linear state, uint k) {
  const vec4 first = FETCH(inverses, 2 * i);
  const uint from = state.iterate * push.count;
  const vec3 stored = FETCH(exchanged, from + i).xyz;
  const vec3 b = FETCH(krylov, i).xyz;
  vec3 product = vec3(0);
  if (first.w > 0) product = first.w * stored + pulls(i, stored, from);
  const Inverse inverse = Inverse(first.xyz, FETCH(inverses, 2 * i + 1).xyz);
  const vec3 r = k == 0 ? b : b - state.next * product;
  const vec3 half_way = half_preconditioned(inverse, r);
  if (k > 0) exchanged[(k % 3) * push.count + i] = vec4(state.next * stored + push.relaxation * preconditioned(inverse, r), 0);
  return vec4(dot(b, stored), dot(stored, product), dot(half_way, half_way), 0);
}

void main() {
  const uint i = gl_GlobalInvocationID.x, k = push.iteration;
  const Linear state = judged(linear[k % 2], k == 0 ? vec4(0) : sum_of_groups((k + 1) % 2), k);
  if (i == 0) linear[(k + 1) % 2] = state;
  if (state.done != 0) return;   // of all threads alike
  const vec4 sum = sum_of_group(i < push.count ? relax(i, state, k) : vec4(0));
  if (gl_LocalInvocationID.x == 0) partial_sums[(k % 2) * groups() + gl_WorkGroupID.x] = sum;
}
