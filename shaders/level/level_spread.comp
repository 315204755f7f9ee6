// level_spread: every particle goes with the nodes of the finest level, by its shares in them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_WRITE(predicted)
GATHER_UINT4(level_shares)
GATHER(level_steps)

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const uvec4 packed = FETCH(level_shares, i);
  if (packed.x == WEFT_NONE) return;
  const LevelShare share = unpack_level_share(packed);
  const vec3 gone = share.part0 * FETCH(level_steps, share.node0).xyz + share.part1 * FETCH(level_steps, share.node1).xyz +
                    share.part2 * FETCH(level_steps, share.node2).xyz;
  predicted[i].xyz = FETCH(predicted, i).xyz + gone;
}
