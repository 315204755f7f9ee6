// contact_finalize: ends the substep of the particles that have candidates. A particle takes the fraction of its step that the planes of its
// candidates allow (contact_limit); then velocity, position and prediction as without contacts (motion/finalize.glsl, which ends it for
// all others).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_WRITE(predicted)
READ_WRITE(uvec4, step_fractions)
READ_WRITE(uvec4, slides)
READ_WRITE(uint, contact_counts)
READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)
READ_WRITE(ivec4, contact_sums)
READ(Collider, colliders)

#include "motion/update_velocity.glsl"
#include "motion/watch_bound.glsl"
#include "reaction/quanta.glsl"
#include "reaction/touched_mesh.glsl"
#include "reaction/mesh.glsl"

#include "contact/wide.glsl"
#define MOVE(i, to) predicted[i] = to
#include "contact/end_substep.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < push.count && is_paired(i)) end_substep(i);
}
