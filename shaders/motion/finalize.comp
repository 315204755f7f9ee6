// hold: ends an iteration that nothing else ends: one whose last relaxing pass cannot settle its particles, because other threads
// still read what settling changes (finalize.glsl). It always settles something.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(predicted)
WRITE(vec4, relaxed)
READ_WRITE(Counters, counters)

#include "motion/finalize.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 p = FETCH(predicted, i);
  leave(i, p);
}
