// implicit_mean: the residual as the nodes of the finest level have it, and before the first iteration the springs' blocks (mean.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(inverses)
GATHER(solve_vectors)
GATHER(collider_filters)
WRITE(vec4, level_residuals)
WRITE(vec4, level_blocks)
READ(Linear, linear)

#include "implicit/implicit.glsl"

// What colliders hold of it: 1 - F (implicit_filter.glsl), times the trace of its springs' block over its mass.
Block held_part(uint i) {
  const vec4 n = FETCH(collider_filters, 2 * i);
  const float stiffness = FETCH(collider_filters, 2 * i + 1).w;
  return Block(stiffness * (1 - n.w - (1 - 2 * n.w) * n.xyz * n.xyz), -stiffness * (1 - 2 * n.w) * n.yzz * n.xxy);
}

// Kinematic particles have neither.
Block block_of(uint i, uint part) {
  const vec4 first = FETCH(inverses, 2 * i);
  if (first.w == 0) return Block(vec3(0), vec3(0));
  if (has_colliders && part == kHeld) return held_part(i);
  return springs_part(Inverse(first.xyz, FETCH(inverses, 2 * i + 1).xyz), first.w);
}

#define RESIDUAL_OF(i) (FETCH(positions, i).w * FETCH(solve_vectors, i).xyz)
#define BLOCK_OF(i, part) block_of(i, part)
#include "implicit/mean.glsl"
#include "implicit/store_means.glsl"
