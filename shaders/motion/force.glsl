// force: the only way in for what changes velocities before the constraints are solved (Stage::force, Changes::velocity).
//
// The velocity update (update_velocity.glsl) takes `predicted` for what free flight made of positions and velocities, to the bit. So velocity
// and prediction change together. With contacts a changed prediction may leave its displacement bound, and calls for a detection then.

#include "motion/motion.glsl"

GATHER(positions)
GATHER_WRITE(velocities)
WRITE(vec4, predicted)
READ_WRITE(Detection, detection)
#include "contact/displacement_bound.glsl"

// Changes particle i's velocity by dv (m/s). Kinematic particles go where they are led. What is not finite, or too large to be squared, is left
// out: one lost neighbour must not take the particle along.
void add_velocity(uint i, vec3 dv) {
  const vec4 x = FETCH(positions, i);
  if (x.w == 0 || !(dot(dv, dv) < 1e20)) return;
  const vec3 v = FETCH(velocities, i).xyz + dv;
  const vec3 p = predicted_position(x.xyz, v, motion.h);
  velocities[i].xyz = v;
  predicted[i].xyz = p;
  if (has_contacts && strays(p, expected_at(i, detection[0].steps + 2), detection[0].margin)) detection[0].needs_detection = 1;
}
