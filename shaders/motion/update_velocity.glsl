// update_velocity: the end of a particle's substep: velocity, position and the prediction of the next substep.
//
// The velocity is corrected by what the constraints changed, v += (p - prediction) / h, not recomputed from positions, so that their
// rounding does not enter it. A particle that is not finite is put back to x, with velocity 0, and counted. Needs push and counters.

#include "motion/motion.glsl"

GATHER_WRITE(positions)
GATHER_WRITE(velocities)
GATHER(materials)

// x: position at the substep's start; p: last iterate; v: the velocity of the prediction. Returns the next substep's prediction, or p where
// the frame ends.
vec4 update_velocity(uint i, vec3 x, vec4 p, vec3 v, float damping_factor) {
  const vec3 corrected = v + motion.inverse_h * (p.xyz - predicted_position(x, v, motion.h));
  if (dot(p.xyz, p.xyz) < 1e20 && dot(corrected, corrected) < 1e20) {
    v = corrected;
  } else {
    atomicAdd(counters[0].non_finite, 1);
    p.xyz = x;
    v = vec3(0);
  }
  positions[i].xyz = p.xyz;
  if ((push.flags & WEFT_LAST_SUBSTEP) == 0) {
    v = driven_velocity(v, motion.gravity, damping_factor, motion.h);
    p.xyz = predicted_position(p.xyz, v, motion.h);
  }
  velocities[i].xyz = v;
  return p;
}
