// implicit_advance: an iteration of conjugate gradients, preconditioned by the blocks on the diagonal, in the form that needs
// one product and one sum (Chronopoulos and Gear 1989): the image s = A p of the direction is carried along with it.
//     b = g / g_before,   a = g / (z . A z - b g / a_before),   g = r . z
//     p = z + b p,   s = A z + b s,   dv += a p,   r -= a s,   z = D^-1 r
// Iteration 0 goes along the guess instead of z, to where the error is least (engine/reference/implicit.h), and begins nothing.
//
// The error falls in every iteration; where the arithmetic leaves no way down the solve rests with what it has.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(inverses)
GATHER_WRITE(exchanged)
GATHER_WRITE(krylov)
READ(vec4, partial_sums)
READ_WRITE(Linear, linear)

layout(push_constant, scalar) uniform Constants { Push push; };

#define SUMS
#include "implicit.glsl"

// Floats resolve no smaller part of a residual.
const float kRounding = 1e-13;   // squared

Linear advanced(Linear before, vec4 sums, uint k) {
  Linear now = before;
  if (k == 0) return Linear(sums.z, sums.z, sums.x, sums.y > 0 ? sums.x / sums.y : 0, 0, 0, 0);
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

// The five parts of krylov: residual, change, product, direction, image.
void go(uint i, Linear state, uint k) {
  const uint n = push.count;
  vec3 direction = FETCH(exchanged, i).xyz, image = FETCH(krylov, 2 * n + i).xyz, change = vec3(0);
  if (k > 0) change = FETCH(krylov, n + i).xyz;
  if (k > 1) {
    direction += state.next * FETCH(krylov, 3 * n + i).xyz;
    image += state.next * FETCH(krylov, 4 * n + i).xyz;
  }
  const vec3 r = FETCH(krylov, i).xyz - state.step * image;
  krylov[i] = vec4(r, 0);
  krylov[n + i] = vec4(change + state.step * direction, 0);
  krylov[3 * n + i] = vec4(direction, 0);
  krylov[4 * n + i] = vec4(image, 0);
  exchanged[i] = vec4(preconditioned(Inverse(FETCH(inverses, 2 * i).xyz, FETCH(inverses, 2 * i + 1).xyz), r), 0);
}

void main() {
  const uint i = gl_GlobalInvocationID.x, k = push.iteration;
  const Linear state = advanced(linear[k % 2], sum_of_groups(0), k);
  if (i == 0) linear[(k + 1) % 2] = state;
  if (i < push.count && state.done == 0) go(i, state, k);
}
