// implicit_mean_wide: the same for a level of many nodes that is not the finest.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

// An earlier dispatch has written the finer level's.
GATHER_WRITE(level_residuals)
GATHER_WRITE(level_blocks)
READ(Linear, linear)

#include "implicit/implicit.glsl"

#define RESIDUAL_OF(k) FETCH(level_residuals, k).xyz
#define BLOCK_OF(k, part) Block(FETCH(level_blocks, 4 * (k) + 2 * (part)).xyz, FETCH(level_blocks, 4 * (k) + 2 * (part) + 1).xyz)
#include "implicit/mean.glsl"
#include "implicit/store_means.glsl"
