// implicit_multiply: conjugate gradients' product w = A z of the matrix with what every particle offers (exchanged), gathered
// spring by spring, and what the iteration needs to know of all particles: r . z, z . A z and r . D^-1 r.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT2(spring_rows)
GATHER_UINT4(spring_ends)
GATHER(spring_blocks)
GATHER(inverses)
GATHER(exchanged)
GATHER_WRITE(krylov)
WRITE(vec4, partial_sums)

layout(push_constant, scalar) uniform Constants { Push push; };

#include "implicit.glsl"
#include "implicit_row.glsl"

// Held particles have neither mass nor residual.
vec4 multiply(uint i) {
  const vec4 first = FETCH(inverses, 2 * i);
  vec3 product = vec3(0);
  const vec3 z = FETCH(exchanged, i).xyz;
  if (first.w > 0) product = first.w * z + pulls(i, z, 0);
  krylov[2 * push.count + i] = vec4(product, 0);
  const vec3 r = FETCH(krylov, i).xyz;
  const vec3 half_way = half_preconditioned(Inverse(first.xyz, FETCH(inverses, 2 * i + 1).xyz), r);
  return vec4(dot(r, z), dot(z, product), dot(half_way, half_way), 0);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  const vec4 sum = sum_of_group(i < push.count ? multiply(i) : vec4(0));
  if (gl_LocalInvocationID.x == 0) partial_sums[gl_WorkGroupID.x] = sum;
}
