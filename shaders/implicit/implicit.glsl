// What the passes of an implicit substep share: the block on the diagonal, and sums over all particles.
//
// Sums are reductions in two stages, each in a fixed order, so that they have the same bits every time: every workgroup writes a partial
// sum of its own particles, and the workgroup that finishes last adds these up, and alone decides how the solve goes on. That costs no
// dispatch of its own and no atomics but a count.

// The diagonal block D = C C^T (Cholesky). `inverses` has the inverse of C, lower triangular, so that D^-1 stays positive definite in spite
// of rounding.

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

shared vec4 values[gl_WorkGroupSize.x];

// The sum over a workgroup, all of whose threads must call it; valid for the first thread, which adds alone: on the software driver the
// barriers of a parallel reduction cost more than that.
vec4 sum_of_group(vec4 value) {
  values[gl_LocalInvocationID.x] = value;
  barrier();
  if (gl_LocalInvocationID.x == 0)
    for (uint k = 1; k < gl_WorkGroupSize.x; ++k) value += values[k];
  return value;
}
