// level_centre: where the finest level's nodes are.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
GATHER(supports)
WRITE(vec4, level_supports)
WRITE(vec4, level_centres)
WRITE(vec4, level_middles)
const uint kAtOnce = 1;
#define CENTRE_OF(i) FETCH(predicted, i)
#define MIDDLE_OF(i) FETCH(predicted, i)
#define PUT_OUT_OF(i) FETCH(supports, i)
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
