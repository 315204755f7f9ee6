// motion_constraint: with contacts, where a max distance or a backstop will take a particle in this substep, before candidates are looked for.
// A detection then gives it a trajectory along with its animated place; otherwise its displacement bound would hold it back where that is
// faster. What is soft (a stiffness below 1) gets there as slowly as forces do, and waits.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

#include "motion/force.glsl"
#include "motion_constraint/motion_constraint.glsl"

// push.count: particles of cloth.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count || FETCH(motion_targets, 4 * i + 1).w < 1) return;
  const vec3 p = predicted_position(departure_of(i, FETCH(positions, i).xyz), FETCH(velocities, i).xyz, motion.h);
  const vec3 within = within_motion_constraint(i, p);
  if (within != p) add_velocity(i, motion.inverse_h * (within - p));
}
