// level_wide: a level of many nodes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT4(level_nodes)
GATHER(level_centres)
GATHER_WRITE(level_steps)
// Earlier dispatches have written these.
#define CENTRE(k) FETCH(level_centres, k)
#define STEP(k) FETCH(level_steps, k)
#define PLACE(k) place_of(k, unpack_level_node(FETCH(level_nodes, k)))
#include "level/level.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  level_steps[k].xyz = step_of(k);
}
