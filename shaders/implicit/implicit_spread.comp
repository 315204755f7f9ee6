// implicit_spread: the preconditioned residual where levels belong to the preconditioner: by a particle's own block, and by the nodes of
// the finest level (mean.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(inverses)
GATHER(solve_vectors)
GATHER(collider_filters)
GATHER(level_changes)
GATHER_UINT4(level_shares)
WRITE(vec4, exchanged)
READ(Linear, linear)

#include "implicit/implicit.glsl"
#include "implicit/implicit_filter.glsl"

vec3 carried(uint i) {
  const uvec4 packed = FETCH(level_shares, i);
  if (packed.x == WEFT_NONE) return vec3(0);
  const LevelShare share = unpack_level_share(packed);
  const vec3 change = share.part0 * FETCH(level_changes, share.node0).xyz + share.part1 * FETCH(level_changes, share.node1).xyz +
                      share.part2 * FETCH(level_changes, share.node2).xyz;
  return has_colliders ? apply_filter(FETCH(collider_filters, 2 * i), change) : change;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count || linear[0].done != 0) return;
  const vec4 first = FETCH(inverses, 2 * i);
  if (first.w == 0) return;   // kinematic
  const vec3 own = preconditioned(Inverse(first.xyz, FETCH(inverses, 2 * i + 1).xyz), FETCH(solve_vectors, i).xyz);
  exchanged[i] = vec4(own + carried(i), 0);
}
