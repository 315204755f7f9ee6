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
//
// With reactions each hand is told what it gave: h times the force of the spring where the particle came to be, k (T - q) + c (u - (q - x)
// / h), which is by the above what changed the cloth's momentum, whatever constraints did. It is known when the next substep begins.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
#include "motion/motion.glsl"
#include "bdf2/bdf2.glsl"

READ(Grab, grabs)
GATHER(positions)
READ_WRITE(vec4, velocities)
READ_WRITE(vec4, predicted)
READ_WRITE(Detection, detection)
#include "motion/displacement_bound.glsl"
READ_WRITE(LastPull, last_pulls)
#include "reaction/quanta.glsl"

struct Pulled {
  vec3 velocity;   // m/s
  float mass;      // kg
  float part;      // of the grip's stiffness and damping, as the limited force leaves
};

vec3 target_of(Grab grab) { return unpack(grab.from) + push.fraction_to * (unpack(grab.to) - unpack(grab.from)); }
vec3 target_velocity_of(Grab grab) {
  return (push.fraction_to - push.fraction_from) * motion.inverse_substep * (unpack(grab.to) - unpack(grab.from));
}

// m: inverse mass times this is what the particle weighs before this hand.
Pulled pull(Grab grab, vec3 x, vec3 v, float mass) {
  const float h = motion.h;
  const vec3 target = target_of(grab), target_velocity = target_velocity_of(grab);
  const vec3 force = grab.stiffness * (target - (x + h * v)) + grab.damping * (target_velocity - v);
  const float size = length(force), part = size > grab.force ? grab.force / size : 1;
  const float heavier = mass + part * (h * grab.damping + h * h * grab.stiffness);
  const vec3 dv = h * part / heavier * force;
  if (!(dot(dv, dv) < 1e20)) return Pulled(v, mass, 0);   // not finite: it will be put back
  return Pulled(v + dv, heavier, part);
}

bool is_pulled(Grab grab) { return grab.particle != WEFT_NONE && FETCH(positions, grab.particle).w > 0; }

// What corner k gave to its hand in the last substep: the opposite of what it got, at the hand.
void tell(uint k) {
  const LastPull last = last_pulls[k];
  if (last.particle == WEFT_NONE) return;
  const vec3 q = FETCH(positions, last.particle).xyz, target = unpack(last.target);
  const vec3 force = last.stiffness * (target - q) + last.damping * (unpack(last.velocity) - motion.inverse_substep * (q - unpack(last.place)));
  last_pulls[k].particle = WEFT_NONE;
  if (!(dot(force, force) < 1e20)) return;
  const vec3 impulse = -reaction_settings.quanta * motion.h * motion.h * force;   // quanta are of m d / h
  const vec3 angular = cross(target - unpack(last.hand), impulse);
  const uint hand = planes + spheres + capsules + boxes + k / 3;
  for (int c = 0; c < 3; ++c) {
    add_quanta(hand, c, impulse[c]);
    add_quanta(hand, 3 + c, angular[c]);
  }
}

// Where the hand of corner k is: the mean of the targets of its corners, by their shares.
vec3 hand_of(uint k) {
  vec4 sum = vec4(0);
  for (uint c = k / 3 * 3; c < k / 3 * 3 + 3; ++c)
    if (grabs[c].particle != WEFT_NONE) sum += grabs[c].stiffness * vec4(target_of(grabs[c]), 1);
  return sum.xyz / sum.w;
}

void remember(uint k, Grab grab, vec3 place, float part) {
  last_pulls[k] = LastPull(grab.particle, part * grab.stiffness, part * grab.damping, pack(place), pack(target_of(grab)),
                           pack(target_velocity_of(grab)), pack(hand_of(k)));
}

void main() {
  if (gl_GlobalInvocationID.x > 0) return;
  if (reacts)
    for (uint k = 0; k < grab_count; ++k) tell(k);
  for (uint k = 0; k < grab_count; ++k)
    if (is_pulled(grabs[k])) predicted[grabs[k].particle].w = grabs[k].weight;
  for (uint k = 0; k < grab_count; ++k) {
    const Grab grab = grabs[k];
    if (!is_pulled(grab)) continue;
    const uint i = grab.particle;
    const vec4 x = FETCH(positions, i);
    const vec3 from = departure_of(i, x.xyz);
    // An iterate's weight falls as the mass grows.
    const float mass = grab.weight / (x.w * predicted[i].w);
    const Pulled pulled = pull(grab, from, velocities[i].xyz, mass);
    const vec3 p = predicted_position(from, pulled.velocity, motion.h);
    if (reacts) remember(k, grab, x.xyz, pulled.part);
    velocities[i].xyz = pulled.velocity;
    predicted[i] = vec4(p, predicted[i].w * (mass / pulled.mass));
    if (has_contacts && strays(p, expected_of(i, detection[0].steps).next, bound_of(i))) detection[0].needs_detection = 1;
  }
}
