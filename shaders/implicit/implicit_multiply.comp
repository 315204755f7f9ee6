// implicit_multiply: the product w = A z of an iteration of conjugate gradients, gathered spring by spring, and the step lengths that
// follow from it.
//
// Conjugate gradients preconditioned by the diagonal blocks, in the form that needs one product and one sum an iteration
// (Chronopoulos and Gear 1989): the image s = A p of the direction is updated along with it.
//     b = g / g_before,   a = g / (z . w - b g / a_before),   g = r . z
//     p = z + b p,   s = w + b s,   dv += a p,   r -= a s,   z = D^-1 r      (implicit_advance)
// Iteration 0 is a line search along the guess instead of z (engine/reference/implicit.h); the recurrences begin after it.
//
// The error falls in every iteration. Where rounding leaves no descent the solve stops with the iterate that it has.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT2(spring_rows)
GATHER_UINT4(spring_ends)
GATHER(spring_blocks)
GATHER(inverses)
GATHER(exchanged)
GATHER_WRITE(solve_vectors)
SHARE(vec4, partial_sums)
SHARE(Linear, linear)

#include "implicit/implicit_sum.glsl"
#include "implicit/implicit_row.glsl"

// The smallest residual that floats resolve, relative to the first, squared.
const float kRounding = 1e-13;

// For the sum: r . z, z . A z and r . D^-1 r. Kinematic particles have neither mass nor residual.
vec4 multiply(uint i) {
  const vec4 first = FETCH(inverses, 2 * i);
  vec3 product = vec3(0);
  const vec3 z = FETCH(exchanged, i).xyz;
  if (first.w > 0) product = filtered(i, first.w * z + pulls(i, z, 0));
  solve_vectors[2 * push.count + i] = vec4(product, 0);
  const vec3 r = FETCH(solve_vectors, i).xyz;
  const vec3 half_way = half_preconditioned(Inverse(first.xyz, FETCH(inverses, 2 * i + 1).xyz), r);
  return vec4(dot(r, z), dot(z, product), dot(half_way, half_way), 0);
}

Linear next_state(Linear before, vec4 sums, uint k) {
  if (k == 0) return Linear(sums.z, sums.z, sums.x, sums.y > 0 ? sums.x / sums.y : 0, 0, 0, 0, 0);
  Linear now = before;
  now.arrived = 0;
  if (before.done != 0) return now;
  now.gamma = sums.x;
  now.squared = sums.z;
  now.next = k == 1 ? 0 : sums.x / before.gamma;
  const float curvature = sums.y - (k == 1 ? 0 : now.next * sums.x / before.step);
  now.step = sums.x / curvature;
  if (!(sums.z > kRounding * now.first)) now.done = 1;
  else if (!(curvature > 0 && now.step < 1e20 && now.next < 1e20)) now.done = 2;
  return now;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  vec4 sums;
  if (sum_of_all(i < push.count ? multiply(i) : vec4(0), sums)) linear[0] = next_state(linear[0], sums, push.iteration);
}
