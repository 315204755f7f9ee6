// bend: bending about flat (engine/effects/bend: a lattice, or hinges) in one visit a substep.
//
// A stencil's constraint l = sum K_j p_j = 0 is linear, and with one visit a substep its multiplier starts at zero, so that a step of it, or
// several (solver.bend_steps), are a constant sparse matrix: dp_i = -sum_j M_ij (p_j - p_i), summed when cooking
// (engine/effects/bend/matrix.cpp). The pass multiplies.
// Because every row of M sums to zero only differences enter, so that the distance from the origin costs no precision.
// Scenes with more iterations use bend_lambda and bend_gather.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
GATHER_UINT2(bend_rows)
GATHER_UINT4(bend_entries)
WRITE(vec4, next_iterate)
READ_WRITE(Counters, counters)

#include "motion/finalize.glsl"

vec3 share(vec3 p, uvec2 entry) {
  return uintBitsToFloat(entry.y) * (FETCH(predicted, entry.x).xyz - p);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 p = FETCH(predicted, i);
  const uvec2 row = FETCH_UINT2(bend_rows, i);
  const uint end = row.x + ((row.y + 1) >> 1);
  vec3 sum = vec3(0);
  for (uint k = row.x; k < end; ++k) {
    const uvec4 pair = FETCH(bend_entries, k);
    sum += share(p.xyz, pair.xy) + share(p.xyz, pair.zw);
  }
  // A neighbour that is not finite must not spoil this particle.
  const bool usable = dot(sum, sum) < 1e20;
  const vec4 next = vec4(usable ? p.xyz - sum : p.xyz, p.w);
  leave(i, next);
}
