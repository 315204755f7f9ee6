// predict: symplectic Euler, or in second order bdf2/bdf2.glsl: where every particle would go in the frame's first substep if nothing held
// it. The predictions of later substeps are made at the end of the one before (update_velocity.glsl). A kinematic particle stays.
// With contacts it also asks for a detection where a prediction is about to leave its displacement bound (displacement_bound.glsl); the
// anchor pass does so for anchors.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
#include "motion/motion.glsl"
#include "bdf2/bdf2.glsl"

GATHER(positions)
GATHER(materials)
GATHER_WRITE(velocities)
WRITE(vec4, predicted)

READ_WRITE(Detection, detection)
#include "motion/displacement_bound.glsl"

vec3 free_flight(uint i, vec3 x) {
  const vec4 v = FETCH(velocities, i);
  const float damping_factor = FETCH(materials, floatBitsToUint(v.w)).x;
  const Steps steps = kept_steps(i, v.xyz);
  const vec3 predicted_v = driven(i, steps, damping_factor);
  velocities[i].xyz = predicted_v;
  return predicted_position(departure(x, steps), predicted_v, motion.h);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 x = FETCH(positions, i);
  if (x.w == 0) return;
  const vec3 p = free_flight(i, x.xyz);
  predicted[i].xyz = p;
  if (has_contacts && strays(p, expected_of(i, detection[0].steps).next, bound_of(i))) detection[0].needs_detection = 1;
}
