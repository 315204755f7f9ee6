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

// A symmetric block: xx, yy, zz; yx, zx, zy.
struct Block {
  vec3 diagonal, below;
};

// The parts of a node's block (mean.glsl); the second only where there are colliders.
const uint kSprings = 0, kHeld = 1;
const uint kParts = has_colliders ? 2 : 1;

// What springs add to a particle's block (kg), by its inverse factor and the mass; not below 0 by rounding.
Block springs_part(Inverse c, float mass) {
  const vec3 d = 1 / c.diagonal;   // of C, whose inverse is c
  const float yx = -c.below.x * d.x * d.y;
  const float zx = -(c.below.y * d.x + c.below.z * yx) * d.z, zy = -c.below.z * d.y * d.z;
  const vec3 diagonal = vec3(d.x * d.x, yx * yx + d.y * d.y, zx * zx + zy * zy + d.z * d.z);
  return Block(max(diagonal - mass, vec3(0)), vec3(yx * d.x, zx * d.x, zx * yx + zy * d.y));
}

// Of a block with this diagonal (xx, yy, zz) and this below it (yx, zx, zy); in exact arithmetic no pivot is below `least`.
Inverse factor_of(vec3 diagonal, vec3 below, float least) {
  const float x = inversesqrt(max(diagonal.x, least));
  const float yx = below.x * x, zx = below.y * x;
  const float y = inversesqrt(max(diagonal.y - yx * yx, least));
  const float zy = (below.z - zx * yx) * y;
  const float z = inversesqrt(max(diagonal.z - zx * zx - zy * zy, least));
  return Inverse(vec3(x, y, z), vec3(-yx * x * y, (zy * yx * y - zx) * x * z, -zy * y * z));
}

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
