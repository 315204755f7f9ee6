// update_velocity: what ends a particle's substep: velocity, position and the prediction of the substep that follows.
//
// The velocity is corrected by what the constraints changed, v += (p - prediction) / h, and not recomputed from positions,
// whose rounding would enter it. A particle that turned non-finite goes back to x, at rest, and is counted. Needs push and counters.

#include "motion/motion.glsl"

GATHER_WRITE(positions)
GATHER_WRITE(velocities)
GATHER(materials)

// From the substep's start x, where the constraints left the particle, p, and the velocity v that it was predicted with: its next
// iterate, a prediction unless the frame is over.
vec4 update_velocity(uint i, vec3 x, vec4 p, vec3 v, float keep) {
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
    v = driven_velocity(v, motion.gravity, keep, motion.h);
    p.xyz = predicted_position(p.xyz, v, motion.h);
  }
  velocities[i].xyz = v;
  return p;
}
