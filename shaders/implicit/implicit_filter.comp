// implicit_filter: the right side of an implicit substep's equations where colliders change the free flight by z
// (implicit_collide.glsl): the springs respond to that, b <- b - h^2 K z - h D z, in the directions that are free.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT2(spring_rows)
GATHER_UINT4(spring_ends)
GATHER(spring_blocks)
GATHER_WRITE(solve_vectors)

#define OFFERED(i) FETCH(collider_filters, 2 * (i) + 1).xyz
#include "implicit/implicit_row.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  solve_vectors[i] = vec4(FETCH(solve_vectors, i).xyz - filtered(i, pulls(i, OFFERED(i), 0)), 0);
}
