// implicit_mean: the residual as the nodes of the finest level have it, and before the first iteration the springs' blocks (mean.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(inverses)
GATHER(solve_vectors)
WRITE(vec4, level_residuals)
WRITE(vec4, level_blocks)
READ(Linear, linear)

#include "implicit/implicit.glsl"

// Kinematic particles have neither.
Block block_of(uint i) {
  const vec4 first = FETCH(inverses, 2 * i);
  if (first.w == 0) return Block(vec3(0), vec3(0));
  return springs_part(Inverse(first.xyz, FETCH(inverses, 2 * i + 1).xyz), first.w);
}

#define RESIDUAL_OF(i) FETCH(positions, i).w * FETCH(solve_vectors, i).xyz
#define BLOCK_OF(i) block_of(i)
#include "implicit/mean.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= push.count || linear[0].done != 0) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  level_residuals[k] = vec4(mean_residual(k), 0);
  if (push.iteration > 0) return;
  const Block block = mean_block(k);
  level_blocks[2 * k] = vec4(block.diagonal, 0);
  level_blocks[2 * k + 1] = vec4(block.below, 0);
}
