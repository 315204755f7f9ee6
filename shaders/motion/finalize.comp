// finalize: ends an iteration that no other pass can end, because other threads of its last pass still read what the velocity update
// changes (finalize.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
WRITE(vec4, next_iterate)
READ_WRITE(Counters, counters)

#include "motion/finalize.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 p = FETCH(predicted, i);
  leave(i, p);
}
