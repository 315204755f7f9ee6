// implicit_advance: an iteration of conjugate gradients, as far as implicit_multiply says and in the terms that it explains.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(inverses)
GATHER_WRITE(exchanged)
GATHER_WRITE(krylov)
READ(Linear, linear)

#include "implicit/implicit.glsl"

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
  const uint i = gl_GlobalInvocationID.x;
  const Linear state = linear[0];
  if (i < push.count && state.done == 0) go(i, state, push.iteration);
}
