// implicit_advance: the vector updates of a conjugate gradient iteration, as implicit_multiply derives them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(inverses)
GATHER_WRITE(exchanged)
GATHER_WRITE(solve_vectors)
READ(Linear, linear)

#include "implicit/implicit.glsl"

// The five parts of solve_vectors: residual, change, product, direction, image.
void update(uint i, Linear state, uint k) {
  const uint n = push.count;
  vec3 direction = FETCH(exchanged, i).xyz, image = FETCH(solve_vectors, 2 * n + i).xyz, change = vec3(0);
  if (k > 0) change = FETCH(solve_vectors, n + i).xyz;
  if (k > 1) {
    direction += state.next * FETCH(solve_vectors, 3 * n + i).xyz;
    image += state.next * FETCH(solve_vectors, 4 * n + i).xyz;
  }
  const vec3 r = FETCH(solve_vectors, i).xyz - state.step * image;
  solve_vectors[i] = vec4(r, 0);
  solve_vectors[n + i] = vec4(change + state.step * direction, 0);
  solve_vectors[3 * n + i] = vec4(direction, 0);
  solve_vectors[4 * n + i] = vec4(image, 0);
  if (has_levels) return;   // implicit_spread does that
  exchanged[i] = vec4(preconditioned(Inverse(FETCH(inverses, 2 * i).xyz, FETCH(inverses, 2 * i + 1).xyz), r), 0);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  const Linear state = linear[0];
  if (i < push.count && state.done == 0) update(i, state, push.iteration);
}
