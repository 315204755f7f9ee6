// implicit_wide: the change that a level of many nodes asks for (mean.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(level_residuals)
GATHER(level_blocks)
GATHER_WRITE(level_changes)
READ(Linear, linear)

#include "implicit/implicit.glsl"

#define RESIDUAL_OF(k) FETCH(level_residuals, k).xyz
#define BLOCK_OF(k, part) Block(FETCH(level_blocks, 4 * (k) + 2 * (part)).xyz, FETCH(level_blocks, 4 * (k) + 2 * (part) + 1).xyz)
#define CHANGE(k) FETCH(level_changes, k).xyz
#include "implicit/level_change.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= push.count || linear[0].done != 0) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  level_changes[k] = vec4(change_of_node(k), 0);
}
