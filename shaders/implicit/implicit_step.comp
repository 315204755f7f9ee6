// implicit_step: the new position by the solution, p = x + h (v* + dv), less the drift of a free cloth (implicit_drift); finalize does the
// rest. Reports the residual.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
READ(Linear, linear)
READ(FreeCloth, free_cloths)
WRITE(vec4, next_iterate)
READ_WRITE(Counters, counters)

#include "motion/finalize.glsl"

#include "implicit/implicit_change.glsl"
#include "motion/body.glsl"

void report(Linear state) {
  const float left = state.first > 0 ? sqrt(state.squared / state.first) : 0;
  counters[0].residual = left;
  if (left > WEFT_CONVERGED) counters[0].unconverged += 1;
  if (state.done == 2) counters[0].stopped += 1;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  const Linear state = linear[0];
  if (i == 0) report(state);
  if (i >= push.count) return;
  vec4 p = FETCH(predicted, i);
  if (p.w != 0) p.xyz += motion.h * (change_of(i, state, push.count) - unpack(free_cloths[body_of(i)].drift));
  leave(i, p);
}
