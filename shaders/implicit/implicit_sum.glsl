// Sums over all particles of an implicit substep (implicit.glsl says how). Needs partial_sums and linear.

#include "implicit/implicit.glsl"

shared bool last;

// The sum over all threads of a dispatch, which must all call it. True for one thread, which then has the sum.
bool sum_of_all(vec4 value, out vec4 sum) {
  const uint thread = gl_LocalInvocationID.x;
  sum = sum_of_group(value);
  if (thread == 0) {
    partial_sums[gl_WorkGroupID.x] = sum;
    memoryBarrierBuffer();
    last = atomicAdd(linear[0].arrived, 1) == gl_NumWorkGroups.x - 1;
  }
  barrier();
  if (!last) return false;
  memoryBarrierBuffer();
  value = vec4(0);
  for (uint k = thread; k < gl_NumWorkGroups.x; k += gl_WorkGroupSize.x) value += partial_sums[k];
  sum = sum_of_group(value);
  return thread == 0;
}
