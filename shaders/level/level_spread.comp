// level_spread: every particle goes with the nodes of the finest level.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_WRITE(predicted)
#include "level/spread.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  predicted[i].xyz = FETCH(predicted, i).xyz + spread(i);
}
