// bdf2: second order in time, by the backward differentiation formula of two steps (Curtiss and Hirschfelder 1952; Gear 1971):
//     x1 = (4 x0 - x_) / 3 + 2/3 h v1,     v1 = (4 v0 - v_) / 3 + 2/3 h a1,
// where x_, v_ are from a substep before x0, v0. Implicit Euler is x1 = x0 + h v1, v1 = v0 + h a1. So the solve is the same, about
// another place and velocity, and over b = 2/3 h (Motion::h) instead of h (Motion::substep):
//     v* = (4 v0 - v_) / 3 + b g,   p* = (4 x0 - x_) / 3 + b v*,   v1 = v* + (x1 - p*) / b.
//
// What is kept of the substep before are two small differences, so that nothing is wrong where the host puts particles or throws them:
//     c = v0 - v_,    r = x0 - x_ - h v0,    thus (4 v0 - v_) / 3 = v0 + c / 3,  (4 x0 - x_) / 3 = x0 + (h v0 + r) / 3.
// In free fall c = h g and r = -h^2 g / 2, and the parabola is exact.
//
// A collider's push q is an event and no force: by the formula cloth that strikes a floor would leave it at up to half its speed. So
// along q the velocity is that of the way, (x1 - x0) / h, as by implicit Euler, and c leaves that change out.
//
// `is_second_order` is a constant; without it none of this is there. Needs motion/motion.glsl.

READ_WRITE(vec4, velocity_changes)
READ_WRITE(vec4, step_remainders)
READ_WRITE(vec4, velocities_before)

const float one_third = 1.0 / 3.0;

// From where the prediction of particle i, at x when the substep begins, leaves (m).
vec3 departure_of(uint i, vec3 x) {
  if (!is_second_order) return x;
  precise const vec3 from = x + one_third * (motion.substep * velocities_before[i].xyz + step_remainders[i].xyz);
  return from;
}

// v: when the substep begins (m/s). Returns v*.
vec3 driven(uint i, vec3 v, float damping_factor) {
  if (!is_second_order) return driven_velocity(v, motion.gravity, damping_factor, motion.h);
  velocities_before[i] = vec4(v, 0);
  return driven_velocity(v + one_third * velocity_changes[i].xyz, motion.gravity, damping_factor, motion.h);
}

// Ends the substep in which particle i went from x to p, the last part of it, `pushed`, pushed by colliders. `solved`: its velocity as
// constraints left it. Returns that with the push.
vec3 stepped(uint i, vec3 x, vec3 p, vec3 pushed, vec3 solved) {
  vec3 v = solved;
  const float squared = dot(pushed, pushed);
  if (squared > 0) v += max(dot(motion.inverse_substep * (p - x) - solved, pushed), 0) / squared * pushed;
  velocity_changes[i] = vec4(solved - velocities_before[i].xyz, 0);
  step_remainders[i] = vec4(p - x - motion.substep * v, 0);
  return v;
}

// A particle that was put back.
void forget_steps(uint i) { velocity_changes[i] = step_remainders[i] = vec4(0); }
