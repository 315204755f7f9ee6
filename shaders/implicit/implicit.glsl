// What the passes of an implicit substep share: the block on the diagonal, and sums over all particles.
//
// A sum is made in two stages, each in a fixed order, so that it has the same bits every time: every workgroup adds up its own
// particles and leaves a partial sum, and the workgroup that happens to be the last adds these up. It alone then says how
// the solve goes on. That costs no dispatch of its own and no atomics but a count.

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

// Of all threads of a workgroup, which must all call it. For the first thread, which adds up alone: a barrier more, for others to help
// it, costs the software driver more than that.
vec4 sum_of_group(vec4 value) {
  values[gl_LocalInvocationID.x] = value;
  barrier();
  if (gl_LocalInvocationID.x == 0)
    for (uint k = 1; k < gl_WorkGroupSize.x; ++k) value += values[k];
  return value;
}
