// contact_apply: moves each particle that has active contacts by the sum of its contacts' corrections [within its motion constraints,
// and out of colliders]. The last iteration also keeps it
// within its displacement bound, on which detection relies (displacement_bound.glsl). A bound of 0 means that a candidate of this particle
// has overflowed: it stays where the substep began.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_WRITE(predicted)
READ_WRITE(Detection, detection)
GATHER_UINT(touched_particles)
READ_WRITE(ivec4, contact_sums)
READ_WRITE(uint, contact_penetrations)
READ_WRITE(Counters, counters)
READ(vec4, ways_out)

GATHER(velocities)
GATHER(materials)
#include "collide/colliders.glsl"
#include "reaction/touched_mesh.glsl"
#include "reaction/mesh.glsl"
#include "motion/displacement_bound.glsl"
#include "motion_constraint/motion_constraint.glsl"

#define ITERATE(i) FETCH(predicted, i)
#define MOVE(i, to) predicted[i] = to
#include "contact/apply.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place < detection[0].touchings) apply_corrections(FETCH_UINT(touched_particles, place));
  if (place != 0) return;
  detection[0].listings[WEFT_PENETRATING] = 0;   // for the next iteration
  detection[0].listed[WEFT_PENETRATING] = Groups(0, 1, 1);
}
