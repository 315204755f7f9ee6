// The free motion of a substep. `predict` makes the prediction and settle makes it again to see what the constraints
// changed: only then does rounding in the position leave the velocity alone (a falling sheet keeps its closed form).
// `precise` keeps both evaluations the same to the bit, so that it does not matter where a frame ends either.

vec3 predicted_position(vec3 x, vec3 v, float h) {
  precise vec3 p = x + h * v;
  return p;
}

vec3 driven_velocity(vec3 v, vec3 gravity, float keep, float h) {
  precise vec3 driven = keep * (v + h * gravity);
  return driven;
}
