// accelerate: Chebyshev's step from a Jacobi iterate to the next (accelerate.glsl), then what ends an iteration (finalize.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
WRITE(vec4, relaxed)
READ_WRITE(Acceleration, acceleration)
READ_WRITE(Counters, counters)

#include "motion/finalize.glsl"
#include "chebyshev/accelerate.glsl"

// The substep's first step: where the guard looks. A maximum that is there already needs no atomic.
void watch(uint i, vec3 step) {
  const vec3 before = iterates[3 * i + 2].xyz;
  iterates[3 * i + 2] = vec4(step, 0);
  const uint bits = floatBitsToUint(dot(step, step));
  if (bits > acceleration[0].largest[turn(0)]) atomicMax(acceleration[0].largest[turn(0)], bits);
  if (dot(step, before) < 0 && bits > acceleration[0].turned[turn(0)]) atomicMax(acceleration[0].turned[turn(0)], bits);
}

vec3 accelerated(uint i, vec3 p) {
  if ((push.flags & WEFT_FIRST_ITERATION) != 0) {
    const vec3 start = predicted_position(FETCH(positions, i).xyz, FETCH(velocities, i).xyz, motion.h);
    watch(i, p - start);
    iterates[3 * i] = vec4(start, 0);
    return p;
  }
  const vec3 older = iterates[3 * i].xyz;
  iterates[3 * i] = iterates[3 * i + 1];
  return older + omega * (p - older);
}

// What the next substep begins with: nobody reads it in this one.
void keep_book() {
  if ((push.flags & WEFT_FIRST_ITERATION) != 0) acceleration[0].largest[turn(2)] = acceleration[0].turned[turn(2)] = 0;
  if ((push.flags & WEFT_LAST_ITERATION) == 0) return;
  const uint rest = acceleration[0].rest[turn(0)];
  acceleration[0].rest[turn(2)] = is_alarming ? recovery : max(rest, 1) - 1;
  acceleration[0].streak[turn(2)] = is_grown ? acceleration[0].streak[turn(0)] + 1 : 0;
  if (!is_steady) ++counters[0].unaccelerated;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  if (i == 0) keep_book();
  vec4 p = FETCH(predicted, i);
  if (p.w != 0) p.xyz = accelerated(i, p.xyz);
  leave(i, p);
}
