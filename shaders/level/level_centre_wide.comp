// level_centre_wide: the centres of a level of many nodes that is not the finest.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_WRITE(level_centres)
#define POINT(k) FETCH(level_centres, k)   // an earlier dispatch has written the finer level's
#include "level/centre.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  level_centres[k].xyz = centre_of(k);
}
