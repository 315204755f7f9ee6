// anchor: tells every held particle where it belongs at the substep's end, on the straight way from where it was at the
// frame's start to where the scene or the host wants it at the frame's end. Without contacts it is recorded only in frames in which
// targets move. At the frame's end the target is taken as it is, so that it is exact to the bit; an anchor that does not move stays so.
//
// With contacts cloth in the way may have held it back (contact_limit). Then it goes after its target, and makes good no more of its lag
// in a substep than contacts make good of a distance that is too small: what comes at cloth with all its lag at once takes all the
// room in front of it, is stopped again, and lags more. Also watches whether it strays (leash.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(Anchor, anchors)
WRITE(vec4, predicted)
GATHER(positions)
GATHER(velocities)
GATHER(materials)
READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)
#include "contact/leash.glsl"

// Where it belongs when so much of the frame is over.
vec3 place_at(Anchor anchor, float fraction) { return fraction == 1 ? anchor.to : anchor.from + fraction * (anchor.to - anchor.from); }

const float kLeast = 0.08;               // of its thickness: what it makes good where contacts make good nothing
const float kRounding = 1.0 / 1048576;   // 2^-20, of a place

// What it is away from where it should have been by now (m).
void count_lag(vec3 x, Anchor anchor) {
  const float behind = length(place_at(anchor, push.fraction_from) - x);
  const vec3 size = abs(x);
  if (behind > kRounding * max(size.x, max(size.y, size.z))) atomicMax(counters[0].lag, floatBitsToUint(behind));   // floats above 0 are ordered as their bits are
}

// Beyond its patience (contact_limit) it does not wait any longer.
vec3 after(vec3 target, vec3 x, Anchor anchor) {
  const float thickness = FETCH(materials, floatBitsToUint(FETCH(velocities, anchor.particle).w)).z;
  const float lag = length(target - x), follows = (push.fraction_to - push.fraction_from) * length(anchor.to - anchor.from);
  const float step = follows + max(contact_settings.recover, kLeast * thickness);
  return lag > step && lag <= contact_settings.patience * thickness ? x + (step / lag) * (target - x) : target;
}

// Where cloth lets it go, and whether that strays.
vec3 among_contacts(vec3 target, Anchor anchor) {
  const vec3 x = FETCH(positions, anchor.particle).xyz;
  count_lag(x, anchor);
  const vec3 next = after(target, x, anchor);
  if (strays(next, expected_at(anchor.particle, detection[0].age + 2), detection[0].reach)) detection[0].due = 1;
  return next;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const Anchor anchor = anchors[i];
  const vec3 target = place_at(anchor, push.fraction_to);
  predicted[anchor.particle].xyz = has_contacts ? among_contacts(target, anchor) : target;
}
