// level_low: the levels of few nodes by one workgroup: their centres, finest first, then their steps, coarsest first.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(uint, level_ends)
// This dispatch has written what it reads of these.
SHARE(vec4, level_centres)
SHARE(vec4, level_places)
SHARE(vec4, level_steps)
#define POINT(k) level_centres[k]
#define CENTRE(k) level_centres[k]
#define PLACE(k) level_places[k]
#define STEP(k) level_steps[k]
#include "level/centre.glsl"
#include "level/level.glsl"

void wait() {
  memoryBarrierBuffer();
  barrier();
}

void main() {
  const uint here = gl_LocalInvocationID.x;
  // level_centre has the finest level's.
  for (uint level = has_wide_levels ? push.count : push.count - 1; level-- > 0;) {
    for (uint k = (level == 0 ? 0 : level_ends[level - 1]) + here; k < level_ends[level]; k += workgroup) level_centres[k].xyz = centre_of(k);
    wait();
  }
  uint first = 0;
  for (uint level = 0; level < push.count; ++level) {
    const uint end = level_ends[level];
    for (uint k = first + here; k < end; k += workgroup) level_places[k] = place_of(k, unpack_level_node(FETCH(level_nodes, k)));
    wait();
    for (uint k = first + here; k < end; k += workgroup) level_steps[k].xyz = step_of(k);
    wait();
    first = end;
  }
}
