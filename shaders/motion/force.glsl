// force: adds to velocities before the constraints are solved. Passes of Stage::force (Changes::velocity) use nothing else.
//
// The velocity update (update_velocity.glsl) relies on `predicted` being, bit for bit, the prediction from positions and
// velocities. So velocity and prediction change together. With contacts, a changed prediction may exceed its displacement bound;
// it then needs detection.

#include "motion/motion.glsl"
#include "bdf2/bdf2.glsl"

GATHER(positions)
GATHER_WRITE(velocities)
WRITE(vec4, predicted)
READ_WRITE(Detection, detection)
#include "motion/displacement_bound.glsl"

// Adds dv (m/s) to particle i's velocity. Kinematic particles are left as they are. A dv that is not finite, or too large to be
// squared, is ignored: a neighbour that is not finite must not spread.
void add_velocity(uint i, vec3 dv) {
  const vec4 x = FETCH(positions, i);
  if (x.w == 0 || !(dot(dv, dv) < 1e20)) return;
  const vec3 v = FETCH(velocities, i).xyz + dv;
  const vec3 p = predicted_position(departure_of(i, x.xyz), v, motion.h);
  velocities[i].xyz = v;
  predicted[i].xyz = p;
  if (has_contacts && strays(p, expected_of(i, detection[0].steps).next, bound_of(i))) detection[0].needs_detection = 1;
}
