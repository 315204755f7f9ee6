// level_spread: every particle goes with the nodes of the finest level.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_WRITE(predicted)
GATHER_WRITE(supports)
#include "support/support.glsl"
#include "level/spread.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec4 support = has_supports ? FETCH(supports, i) : vec4(0);
  predicted[i].xyz = FETCH(predicted, i).xyz + spread(i, support.xyz, support_from(support.xyz), support.w);
  if (has_supports && support.xyz != vec3(0)) supports[i].w = support.w;
}
