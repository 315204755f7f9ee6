// implicit_low: the levels of few nodes by one workgroup: what they have of the residual, finest first, and then the change that they ask
// for, coarsest first (mean.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(uint, level_ends)
READ(Linear, linear)
// This dispatch has written what it reads of these.
SHARE_GATHER(level_residuals)
SHARE_GATHER(level_blocks)
SHARE_GATHER(level_changes)

#include "implicit/implicit.glsl"

#define RESIDUAL_OF(k) LOAD(level_residuals, k).xyz
#define BLOCK_OF(k, part) Block(LOAD(level_blocks, 4 * (k) + 2 * (part)).xyz, LOAD(level_blocks, 4 * (k) + 2 * (part) + 1).xyz)
#define CHANGE(k) LOAD(level_changes, k).xyz
#include "implicit/mean.glsl"
#include "implicit/level_change.glsl"
#include "wait.glsl"

uint first_of(uint level) { return level == 0 ? 0 : level_ends[level - 1]; }

void main() {
  if (linear[0].done != 0) return;   // all threads alike
  const uint here = gl_LocalInvocationID.x;
  // implicit_mean has the finest level's.
  for (uint level = has_wide_levels ? push.count : push.count - 1; level-- > 0;) {
    for (uint k = first_of(level) + here; k < level_ends[level]; k += workgroup) {
      STORE(level_residuals, k, vec4(mean_residual(k), 0))
      for (uint part = 0; part < kParts && push.iteration == 0; ++part) {
        const Block block = mean_block(k, part);
        STORE(level_blocks, 4 * k + 2 * part, vec4(block.diagonal, 0))
        STORE(level_blocks, 4 * k + 2 * part + 1, vec4(block.below, 0))
      }
    }
    wait();
  }
  for (uint level = 0; level < push.count; ++level) {
    for (uint k = first_of(level) + here; k < level_ends[level]; k += workgroup) STORE(level_changes, k, vec4(change_of_node(k), 0))
    wait();
  }
}
