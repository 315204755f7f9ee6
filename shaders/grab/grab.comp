// grab: pulls particles to targets by springs of limited force with damping, in implicit Euler, so that no stiffness, mass or substep makes
// it unstable. Of a particle of mass m, predicted at p with velocity v, a spring k to the target T and damping c against its velocity u make,
// where nothing else acts, the least of
//     m |q - p|^2 / 2 h^2  +  k |q - T|^2 / 2  +  c |q - x - h u|^2 / 2 h,
// that is, of M |q - p'|^2 / 2 h^2 with
//     M = m + h c + h^2 k,   p' = p + h dv,   dv = h (k (T - p) + c (u - v)) / M.
// So the solve gets a particle of mass M with the prediction p', and what constraints it to give way gives way to the spring itself. An
// impulse on m alone would be undone by the links of cloth, whose particles weigh next to nothing.
//
// The force is no more than the grip has: where it would be at p, both k and c are less, for this substep.
//
// One thread takes one corner after another: two hands may hold one particle, whose masses then add up.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
#include "motion/motion.glsl"

READ(Grab, grabs)
GATHER(positions)
READ_WRITE(vec4, velocities)
READ_WRITE(vec4, predicted)
READ_WRITE(Detection, detection)
#include "motion/displacement_bound.glsl"

struct Pulled {
  vec3 velocity;   // m/s
  float mass;      // kg
};

// m: inverse mass times this is what the particle weighs before this hand.
Pulled pull(Grab grab, vec3 x, vec3 v, float mass) {
  const float h = motion.h;
  const vec3 target = grab.from + push.fraction_to * (grab.to - grab.from);
  const vec3 target_velocity = (push.fraction_to - push.fraction_from) * motion.inverse_h * (grab.to - grab.from);
  const vec3 force = grab.stiffness * (target - (x + h * v)) + grab.damping * (target_velocity - v);
  const float size = length(force), part = size > grab.force ? grab.force / size : 1;
  const float heavier = mass + part * (h * grab.damping + h * h * grab.stiffness);
  const vec3 dv = h * part / heavier * force;
  if (!(dot(dv, dv) < 1e20)) return Pulled(v, mass);   // not finite: it will be put back
  return Pulled(v + dv, heavier);
}

bool is_pulled(Grab grab) { return grab.particle != WEFT_NONE && FETCH(positions, grab.particle).w > 0; }

void main() {
  if (gl_GlobalInvocationID.x > 0) return;
  for (uint k = 0; k < grab_count; ++k)
    if (is_pulled(grabs[k])) predicted[grabs[k].particle].w = grabs[k].weight;
  for (uint k = 0; k < grab_count; ++k) {
    const Grab grab = grabs[k];
    if (!is_pulled(grab)) continue;
    const uint i = grab.particle;
    const vec4 x = FETCH(positions, i);
    // An iterate's weight falls as the mass grows.
    const float mass = grab.weight / (x.w * predicted[i].w);
    const Pulled pulled = pull(grab, x.xyz, velocities[i].xyz, mass);
    const vec3 p = predicted_position(x.xyz, pulled.velocity, motion.h);
    velocities[i].xyz = pulled.velocity;
    predicted[i] = vec4(p, predicted[i].w * (mass / pulled.mass));
    if (has_contacts && strays(p, expected_of(i, detection[0].steps).next, bound_of(i))) detection[0].needs_detection = 1;
  }
}
