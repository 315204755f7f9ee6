// contact_slide_apply: moves each particle by what contact_slide asks of it, within its displacement bound.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_WRITE(predicted)
READ(Detection, detection)
READ_WRITE(uvec4, slides)

#include "motion/displacement_bound.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const uvec3 up = slides[2 * i].xyz, down = slides[2 * i + 1].xyz;
  if ((up | down) == uvec3(0)) return;
  slides[2 * i].xyz = slides[2 * i + 1].xyz = uvec3(0);
  const vec3 end = FETCH(predicted, i).xyz + uintBitsToFloat(up) - uintBitsToFloat(down);
  predicted[i].xyz = keep_within_bound(i, FETCH(positions, i).xyz, end, detection[0].steps);
}
