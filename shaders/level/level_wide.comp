// level_wide: a level of many nodes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
GATHER_WRITE(level_steps)
#define STEP(k) FETCH(level_steps, k)   // an earlier dispatch has written it
#include "level/level.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  level_steps[k].xyz = step_of(k);
}
