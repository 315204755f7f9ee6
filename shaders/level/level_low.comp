// level_low: the levels of few nodes, coarsest first, by one workgroup.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
READ(uint, level_ends)
SHARE(vec4, level_steps)
#define STEP(k) level_steps[k]   // this dispatch has written it
#include "level/level.glsl"

void main() {
  uint first = 0;
  for (uint level = 0; level < push.count; ++level) {
    const uint end = level_ends[level];
    for (uint k = first + gl_LocalInvocationID.x; k < end; k += workgroup) level_steps[k].xyz = step_of(k);
    memoryBarrierBuffer();
    barrier();
    first = end;
  }
}
