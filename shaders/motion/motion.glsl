// The free motion of a substep, symplectic Euler. The prediction is computed when a substep begins and again by the velocity update, which
// needs what the constraints changed: so rounding of positions does not enter the velocity (a falling sheet keeps its closed form).
// `precise` makes both evaluations the same to the bit, so that it does not matter where a frame ends either.

vec3 predicted_position(vec3 x, vec3 v, float h) {
  precise vec3 p = x + h * v;
  return p;
}

vec3 driven_velocity(vec3 v, vec3 gravity, float damping_factor, float h) {
  precise vec3 driven = damping_factor * (v + h * gravity);
  return driven;
}
