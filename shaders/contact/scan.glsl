// scan: sums over a workgroup, in shared memory (Hillis and Steele 1986). All of its threads must call these together.

shared uint partial[gl_WorkGroupSize.x];

// Afterwards partial[k] is the sum of the values of threads 0 to k.
void sum_up(uint value) {
  const uint thread = gl_LocalInvocationID.x;
  barrier();   // the sums of an earlier call may still be read
  partial[thread] = value;
  for (uint distance = 1; distance < gl_WorkGroupSize.x; distance *= 2) {
    barrier();
    const uint before = thread >= distance ? partial[thread - distance] : 0;
    barrier();
    partial[thread] += before;
  }
  barrier();
}

uint sum_before_thread(uint value) {
  sum_up(value);
  return partial[gl_LocalInvocationID.x] - value;
}
