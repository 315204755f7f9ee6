// predict: where every particle would go in the frame's first substep if nothing held it (symplectic Euler).
// The predictions of later substeps are made where the one before ends (settle.glsl). An anchor stays.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
#include "motion.glsl"

GATHER(positions)
GATHER(materials)
GATHER_WRITE(velocities)
WRITE(vec4, predicted)

layout(push_constant, scalar) uniform Constants { Push push; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 x = FETCH(positions, i);
  if (x.w == 0) return;
  const vec4 v = FETCH(velocities, i);
  const float keep = FETCH(materials, floatBitsToUint(v.w)).x;
  const vec3 driven = driven_velocity(v.xyz, push.gravity, keep, push.h);
  velocities[i].xyz = driven;
  predicted[i].xyz = predicted_position(x.xyz, driven, push.h);
}
