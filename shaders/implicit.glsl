// What the passes of an implicit substep share: the block on the diagonal, and sums over all particles.
//
// A sum is made in two stages, each in a fixed order, so that it has the same bits every time: a workgroup adds up its own
// particles and writes a partial sum, and every workgroup of the next dispatch adds up all of these for itself. That costs
// no dispatch of its own, and no atomics.

// ---- the block on the diagonal: D = C C^T; `inverses` has the inverse of C, lower triangular, so that D^-1 stays positive
// whatever rounding does.

struct Inverse {
  vec3 diagonal;   // xx, yy, zz
  vec3 below;      // yx, zx, zy
};

vec3 half_preconditioned(Inverse c, vec3 r) {
  return vec3(c.diagonal.x * r.x, c.below.x * r.x + c.diagonal.y * r.y, c.below.y * r.x + c.below.z * r.y + c.diagonal.z * r.z);
}

vec3 preconditioned(Inverse c, vec3 r) {
  const vec3 half_way = half_preconditioned(c, r);
  return vec3(c.diagonal.x * half_way.x + c.below.x * half_way.y + c.below.y * half_way.z,
              c.diagonal.y * half_way.y + c.below.z * half_way.z, c.diagonal.z * half_way.z);
}

// ---- sums

shared vec4 values[gl_WorkGroupSize.x];

const uint kLeaders = 16;

// Of all threads of a workgroup, which must all call it. For the first thread alone.
vec4 sum_of_group(vec4 value) {
  const uint thread = gl_LocalInvocationID.x;
  barrier();   // the sum of an earlier call may still be read
  values[thread] = value;
  barrier();
  vec4 sum = vec4(0);
  if (thread < kLeaders)
    for (uint k = thread; k < gl_WorkGroupSize.x; k += kLeaders) sum += values[k];
  barrier();
  if (thread < kLeaders) values[thread] = sum;
  barrier();
  if (thread == 0)
    for (uint k = 1; k < min(kLeaders, gl_WorkGroupSize.x); ++k) sum += values[k];
  return sum;
}

uint groups() { return (push.count + gl_WorkGroupSize.x - 1) / gl_WorkGroupSize.x; }

#ifdef SUMS
// Of what all workgroups of a dispatch left in this half of partial_sums. For every thread.
vec4 sum_of_groups(uint half_at) {
  vec4 value = vec4(0);
  for (uint k = gl_LocalInvocationID.x; k < groups(); k += gl_WorkGroupSize.x) value += partial_sums[half_at * groups() + k];
  const vec4 sum = sum_of_group(value);
  barrier();
  if (gl_LocalInvocationID.x == 0) values[0] = sum;
  barrier();
  return values[0];
}
#endif
