// level_wide: a level of many nodes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
READ_WRITE(vec4, level_steps)
#include "level/level.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  level_steps[k] = vec4(step_of(k), 0);
}
