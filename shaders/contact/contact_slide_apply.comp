// contact_slide_apply: moves each particle by what contact_slide asks of it, within its displacement bound.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_WRITE(predicted)
READ(Detection, detection)
GATHER_UINT(touched_particles)
READ_WRITE(uvec4, slides)

#include "motion/displacement_bound.glsl"

#define ITERATE(i) FETCH(predicted, i)
#include "contact/slide_apply.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place < detection[0].touchings) slide_along(FETCH_UINT(touched_particles, place));
}
