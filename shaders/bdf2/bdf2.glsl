// bdf2: second order in time, by the backward differentiation formula of two steps (Curtiss and Hirschfelder 1952; Gear 1971):
//     x1 = (4 x0 - x_) / 3 + 2/3 h v1,     v1 = (4 v0 - v_) / 3 + 2/3 h a1,
// where x_, v_ are from a substep before x0, v0. Implicit Euler is x1 = x0 + h v1, v1 = v0 + h a1. So the solve is the same, about
// another place and velocity, and over b = 2/3 h (Motion::h) instead of h (Motion::substep):
//     v* = (4 v0 - v_) / 3 + b g,   p* = (4 x0 - x_) / 3 + b v*,   v1 = v* + (x1 - p*) / b.
//
// What is kept of the substep before are two small differences, so that nothing is wrong where the host puts particles or throws them:
//     c = v0 - v_,    r = x0 - x_ - h v0,    thus (4 v0 - v_) / 3 = v0 + c / 3,  (4 x0 - x_) / 3 = x0 + (h v0 + r) / 3.
// In free fall c = h g and r = -h^2 g / 2, and the parabola is exact. What is put somewhere keeps its c and r: where it lay before, it is
// slower by h g / 2 for good, as if it had been let go half a substep later.
//
// A collider's push q is an event and no force: by the formula cloth would leave a floor at up to 5/4 of the speed with which it strikes.
// So along q the velocity is that of the way, (x1 - x0) / h, as by implicit Euler, and c leaves that change out. Tethers and links that
// catch cloth are forces, and throw it back.
//
// `is_second_order` is a constant; without it none of this is there. Needs motion/motion.glsl.

GATHER_WRITE(velocity_changes)
GATHER_WRITE(step_remainders)
GATHER_WRITE(velocities_before)

const float one_third = 1.0 / 3.0;

// What the next substep needs of the last one, and v, with which that one ended (m/s).
struct Steps {
  vec3 v, change, remainder;
};

// From where a prediction leaves, with x where the substep begins: (4 x0 - x_) / 3 (m).
vec3 departure(vec3 x, Steps steps) {
  if (!is_second_order) return x;
  precise const vec3 from = x + one_third * (motion.substep * steps.v + steps.remainder);
  return from;
}

// That of particle i, whose prediction a pass before this one has made.
vec3 departure_of(uint i, vec3 x) {
  if (!is_second_order) return x;
  return departure(x, Steps(FETCH(velocities_before, i).xyz, vec3(0), FETCH(step_remainders, i).xyz));
}

// v* of particle i.
vec3 driven(uint i, Steps steps, float damping_factor) {
  if (!is_second_order) return driven_velocity(steps.v, motion.gravity, damping_factor, motion.h);
  velocities_before[i] = vec4(steps.v, 0);
  return driven_velocity(steps.v + one_third * steps.change, motion.gravity, damping_factor, motion.h);
}

// When a frame begins; v: its velocity then, which the host may have written.
Steps kept_steps(uint i, vec3 v) {
  if (!is_second_order) return Steps(v, vec3(0), vec3(0));
  return Steps(v, FETCH(velocity_changes, i).xyz, FETCH(step_remainders, i).xyz);
}

// Ends the substep in which particle i went from x to p, the last part of it, `pushed`, pushed by colliders. `solved`: its velocity as
// constraints left it.
Steps stepped(uint i, vec3 x, vec3 p, vec3 pushed, vec3 solved) {
  if (!is_second_order) return Steps(solved, vec3(0), vec3(0));
  Steps steps = Steps(solved, solved - FETCH(velocities_before, i).xyz, vec3(0));
  const float squared = dot(pushed, pushed);
  if (squared > 0) steps.v += max(dot(motion.inverse_substep * (p - x) - solved, pushed), 0) / squared * pushed;
  steps.remainder = p - x - motion.substep * steps.v;
  return steps;
}

// Of what is held: let go, it falls by the parabola.
Steps steps_of_fall() {
  return Steps(vec3(0), motion.substep * motion.gravity, -0.5 * motion.substep * motion.substep * motion.gravity);
}

void keep(uint i, Steps steps) {
  if (!is_second_order) return;
  velocity_changes[i] = vec4(steps.change, 0);
  step_remainders[i] = vec4(steps.remainder, 0);
}
