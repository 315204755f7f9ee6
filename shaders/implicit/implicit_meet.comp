// implicit_meet: what changes of the free flight, by which colliders lead particles to their surfaces (implicit_wall.glsl), do to the
// right side of an implicit substep's equations: the springs pull at it, b <- b - h^2 K z - h D z, in the directions that are left.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT2(spring_rows)
GATHER_UINT4(spring_ends)
GATHER(spring_blocks)
GATHER_WRITE(krylov)

#define OFFERED(i) FETCH(walls, 2 * (i) + 1).xyz
#include "implicit/implicit_row.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  krylov[i] = vec4(FETCH(krylov, i).xyz - filtered(i, pulls(i, OFFERED(i), 0)), 0);
}
