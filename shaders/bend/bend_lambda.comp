// bend_lambda: the multiplier of every bending stencil, for scenes with more than one iteration a substep.
// XPBD on the linear constraint l = sum K_j p_j = 0 (Bergou et al. 2006; Macklin et al. 2016, eq. 18):
// dlambda = -(l + alpha lambda / h^2) / (sum n_j w_j K_j^2 / omega + alpha / h^2). bend_gather sums the impulses by particle.
//
//        2
//       / \       Of a hinge the edge (0, 1) and its opposite vertices. K_0 + K_1 + K_2 + K_3 = 0, so l needs only differences.
//      0---1
//       \ /
//        3
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
READ(Bend, bends)
READ_WRITE(vec4, bend_lambda)
WRITE(vec4, bend_impulses)

READ_WRITE(vec4, bend_steps)
READ(Acceleration, acceleration)
#include "chebyshev/chebyshev.glsl"

vec3 change_of_lambda(Bend bend, vec3 lambda) {
  const vec3 origin = FETCH(predicted, bend.particle[0]).xyz;
  const vec3 l = bend.k[1] * (FETCH(predicted, bend.particle[1]).xyz - origin) +
                 bend.k[2] * (FETCH(predicted, bend.particle[2]).xyz - origin) +
                 bend.k[3] * (FETCH(predicted, bend.particle[3]).xyz - origin);
  const float alpha = bend.compliance * motion.inverse_h2;
  const vec3 change = -relaxation * (l + alpha * lambda) / max(bend.split_weight + relaxation * alpha, 1e-20);
  return dot(change, change) < 1e20 ? change : vec3(0);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const bool first = (push.flags & WEFT_FIRST_ITERATION) != 0;
  const vec3 lambda = first ? vec3(0) : bend_lambda[i].xyz;
  const vec3 change = change_of_lambda(bends[i], lambda);
  vec3 step = change;
  if (is_accelerated) {
    step = omega * change + (omega - 1) * (first ? vec3(0) : bend_steps[i].xyz);
    bend_steps[i] = vec4(step, 0);
  }
  bend_lambda[i] = vec4(lambda + step, 0);
  bend_impulses[i] = vec4(change, 0);
}
