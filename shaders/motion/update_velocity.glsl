// update_velocity: the end of a particle's substep: velocity, position and the prediction of the next substep.
//
// The velocity is corrected by what the constraints changed, v += (p - prediction) / h (Motion::h), not recomputed from positions, so that
// their rounding does not enter it; in second order what colliders have pushed comes extra. A particle that is not finite is put back to x,
// with velocity 0, and counted. Needs push and counters.

#include "motion/motion.glsl"
#include "bdf2/bdf2.glsl"

GATHER_WRITE(positions)
GATHER_WRITE(velocities)
GATHER(materials)

// x: position at the substep's start; p: last iterate, `pushed` by colliders from where the solve left it; v: the velocity of the
// prediction. Returns the next substep's prediction, or p where the frame ends.
vec4 update_velocity(uint i, vec3 x, vec4 p, vec3 pushed, vec3 v, float damping_factor) {
  const vec3 solved = is_second_order ? p.xyz - pushed : p.xyz;
  const vec3 corrected = v + motion.inverse_h * (solved - predicted_position(departure_of(i, x), v, motion.h));
  Steps steps = stepped(i, x, p.xyz, pushed, corrected);
  if (!(dot(p.xyz, p.xyz) < 1e20 && dot(steps.v, steps.v) < 1e20)) {
    atomicAdd(counters[0].non_finite, 1);
    p.xyz = x;
    steps = Steps(vec3(0), vec3(0), vec3(0));
  }
  positions[i].xyz = p.xyz;
  keep(i, steps);
  v = steps.v;
  if ((push.flags & WEFT_LAST_SUBSTEP) == 0) {
    v = driven(i, steps, damping_factor);
    p.xyz = predicted_position(departure(p.xyz, steps), v, motion.h);
  }
  velocities[i].xyz = v;
  return p;
}
