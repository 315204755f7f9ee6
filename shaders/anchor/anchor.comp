// anchor: the targets of kinematic particles at the substep's end, on the straight line from where they were at the frame's start to where
// the scene or the host wants them at the frame's end. Without contacts it is recorded only in frames in which targets move. At the frame's
// end the target is taken as it is, so that it is exact to the bit; so does an anchor that does not move.
//
// With contacts cloth in the way may have held an anchor back (contact_limit). It then catches up with its target, in a substep by no more
// than contacts recover of a separation: an anchor that made good its whole tracking error at once would take all the slack in front of it,
// be stopped again, and fall further behind. Also watches whether it leaves its displacement bound (displacement_bound.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(Anchor, anchors)
WRITE(vec4, predicted)
GATHER(positions)
GATHER_WRITE(velocities)
GATHER(materials)
READ_WRITE(Detection, detection)
WRITE(uint, kinematic_lags)
READ_WRITE(Counters, counters)
#include "motion/displacement_bound.glsl"

// Its target when this fraction of the frame is over.
vec3 place_at(Anchor anchor, float fraction) {
  const vec3 from = unpack(anchor.from), to = unpack(anchor.to);
  return fraction == 1 ? to : from + fraction * (to - from);
}

const float kLeast = 0.08;               // relative to its thickness: what it recovers in a substep at least
const float kRounding = 1.0 / 1048576;   // 2^-20, relative to the largest coordinate

// Records the tracking error: the distance from where it should be at the substep's start (m).
void count_tracking_error(vec3 x, float error) {
  const vec3 size = abs(x);
  // Positive floats are ordered like their bits.
  if (error > kRounding * max(size.x, max(size.y, size.z))) atomicMax(counters[0].tracking_error, floatBitsToUint(error));
}

// Where it goes from x in this substep. `lag`: its tracking error at the substep's start (m). Beyond its kinematic lag limit
// (contact_limit) it goes to its target at once.
vec3 next_place(vec3 target, vec3 x, float lag, Anchor anchor) {
  const float thickness = FETCH(materials, floatBitsToUint(FETCH(velocities, anchor.particle).w)).z;
  const float error = length(target - x), motion_of_frame = length(unpack(anchor.to) - unpack(anchor.from));
  const float step = (push.fraction_to - push.fraction_from) * motion_of_frame + max(contact_settings.recover, kLeast * thickness);
  return error > step && lag <= contact_settings.kinematic_lag_limit * thickness ? x + (step / error) * (target - x) : target;
}

// Where it goes among contacts; asks for a detection if that is about to leave its displacement bound.
vec3 among_contacts(vec3 target, Anchor anchor) {
  const vec3 x = FETCH(positions, anchor.particle).xyz;
  const float lag = length(place_at(anchor, push.fraction_from) - x);
  count_tracking_error(x, lag);
  kinematic_lags[anchor.particle] = floatBitsToUint(lag);
  const vec3 next = next_place(target, x, lag, anchor);
  if (strays(next, expected_of(anchor.particle, detection[0].steps).next, bound_of(anchor.particle))) detection[0].needs_detection = 1;
  const bool rests = next == x && x == FETCH(detected_positions, anchor.particle).xyz && FETCH(trajectories, anchor.particle).xyz == vec3(0);
  if (!rests && detection[0].stirs == 0) detection[0].stirs = 1;
  const float step = distance(next, x);
  if (step > contact_settings.margin_low) atomicMax(detection[0].fastest, floatBitsToUint(step));   // it may push (predicted_track.glsl)
  return next;
}

// A pin begins where it is, which the host does not know. It stays there, or goes from there to its first target: on the straight line that
// is at x now, and at the target when the frame ends.
Anchor from_here(Anchor pin) {
  const bool stays = (pin.particle & WEFT_STAYS) != 0, from_here = (pin.particle & WEFT_FROM_HERE) != 0;
  pin.particle &= ~(WEFT_STAYS | WEFT_FROM_HERE);
  const vec3 x = FETCH(positions, pin.particle).xyz;
  if (stays) pin.to = pack(x);
  const vec3 to = unpack(pin.to);
  if (stays || from_here) pin.from = pack(to - (to - x) / (1 - push.fraction_from));
  return pin;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Anchor anchor = anchors[i];
  if (has_pins) {
    if (anchor.particle == WEFT_NONE) return;
    anchor = from_here(anchor);
  }
  const vec3 target = place_at(anchor, push.fraction_to);
  const vec3 next = has_contacts ? among_contacts(target, anchor) : target;
  predicted[anchor.particle].xyz = next;
  // So that it flies on when it is released.
  if (has_pins) velocities[anchor.particle].xyz = motion.inverse_substep * (next - FETCH(positions, anchor.particle).xyz);
}
