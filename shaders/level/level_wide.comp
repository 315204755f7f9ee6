// level_wide: a level of many nodes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT4(level_nodes)
GATHER(level_centres)
GATHER(level_middles)
GATHER(level_supports)
GATHER_WRITE(level_steps)
// Earlier dispatches have written these.
const uint kLinksAtOnce = 1;
#define CENTRE(k) FETCH(level_centres, k)
#define MIDDLE(k) FETCH(level_middles, k)
#define STEP(k) FETCH(level_steps, k)
#define CARRIED(k, node) vec4(carried_of(k, node), node.inverse_mass * float(node.links))
#define PUT_OUT(k) FETCH(level_supports, k)
#include "support/support.glsl"
#include "level/level.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  level_steps[k] = step_of(k);
}
