// level_centre: the centres of the finest level's nodes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
WRITE(vec4, level_centres)
#define POINT(i) FETCH(predicted, i)
#include "level/centre.glsl"

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  level_centres[k].xyz = centre_of(k);
}
