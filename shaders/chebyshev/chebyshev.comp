// chebyshev: the extrapolation of the Chebyshev semi-iteration after a Jacobi step (chebyshev.glsl), then the end of the iteration
// (finalize.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
WRITE(vec4, next_iterate)
READ_WRITE(Acceleration, acceleration)
READ_WRITE(Counters, counters)

#include "motion/finalize.glsl"
#include "chebyshev/chebyshev.glsl"

// Records the substep's first step for the guard. A step that is not above the maximum so far needs no atomic.
void record_step(uint i, vec3 step) {
  const vec3 before = chebyshev_iterates[3 * i + 2].xyz;
  chebyshev_iterates[3 * i + 2] = vec4(step, 0);
  const uint bits = floatBitsToUint(dot(step, step));
  if (bits > acceleration[0].largest[phase(0)]) atomicMax(acceleration[0].largest[phase(0)], bits);
  if (dot(step, before) < 0 && bits > acceleration[0].reversed[phase(0)]) atomicMax(acceleration[0].reversed[phase(0)], bits);
}

vec3 accelerated(uint i, vec3 p) {
  if ((push.flags & WEFT_FIRST_ITERATION) != 0) {
    const vec3 start = predicted_position(FETCH(positions, i).xyz, FETCH(velocities, i).xyz, motion.h);
    record_step(i, p - start);
    chebyshev_iterates[3 * i] = vec4(start, 0);
    return p;
  }
  const vec3 older = chebyshev_iterates[3 * i].xyz;
  chebyshev_iterates[3 * i] = chebyshev_iterates[3 * i + 1];
  return older + omega * (p - older);
}

// Prepares the guard's state for the next substep, in the phase that no thread reads in this one.
void update_guard() {
  if ((push.flags & WEFT_FIRST_ITERATION) != 0) acceleration[0].largest[phase(2)] = acceleration[0].reversed[phase(2)] = 0;
  if ((push.flags & WEFT_LAST_ITERATION) == 0) return;
  const uint cooldown = acceleration[0].cooldown[phase(0)];
  acceleration[0].cooldown[phase(2)] = is_alarming ? recovery : max(cooldown, 1) - 1;
  acceleration[0].streak[phase(2)] = has_grown > 0 ? acceleration[0].streak[phase(0)] + has_grown : 0;
  if (!is_steady) ++counters[0].unaccelerated;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  if (i == 0) update_guard();
  vec4 p = FETCH(predicted, i);
  if (p.w != 0) p.xyz = accelerated(i, p.xyz);
  leave(i, p);
}
