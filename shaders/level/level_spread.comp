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
  vec4 put_out = has_supports ? FETCH(supports, i) : vec4(0);
  const vec3 support = support_from(put_out.xyz);
  predicted[i].xyz = FETCH(predicted, i).xyz + spread(i, put_out.xyz, support, put_out.w);
  if (has_supports && support != vec3(0)) supports[i].w = put_out.w;
}
