// level_centre_wide: where the nodes of a level of many are that is not the finest.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

// An earlier dispatch has written the finer level's.
GATHER_WRITE(level_centres)
GATHER_WRITE(level_middles)
GATHER_WRITE(level_supports)
const uint kAtOnce = 1;
#define CENTRE_OF(k) FETCH(level_centres, k)
#define MIDDLE_OF(k) FETCH(level_middles, k)
#define PUT_OUT_OF(k) FETCH(level_supports, k)
#include "support/support.glsl"
#include "level/centre.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  const LevelPlace place = place_of(k);
  level_centres[k].xyz = place.centre;
  level_middles[k].xyz = place.middle;
  if (nodes_are_held) level_supports[k].xyz = place.put_out;
}
