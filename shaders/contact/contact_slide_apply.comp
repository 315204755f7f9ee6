// contact_slide_apply: moves each particle by what contact_slide asks of it, within its displacement bound.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_WRITE(predicted)
READ(Detection, detection)
GATHER_UINT(touched_particles)
READ_WRITE(uvec4, slides)
READ_WRITE(ivec4, contact_sums)
READ(Collider, colliders)
GATHER(velocities)
GATHER(materials)

#include "motion/displacement_bound.glsl"

#include "reaction/quanta.glsl"
#include "reaction/touched_mesh.glsl"
#include "reaction/mesh.glsl"

#define ITERATE(i) FETCH(predicted, i)
#define MOVE(i, to) predicted[i] = to
#include "contact/slide_apply.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place < detection[0].touchings) slide_along(FETCH_UINT(touched_particles, place));
}
