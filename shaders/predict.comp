// predict: where every particle would go in the frame's first substep if nothing held it (symplectic Euler).
// The predictions of later substeps are made by settle, which has the particle at hand anyway. An anchor stays.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
#include "motion.glsl"

READ(vec4, positions)
READ(Material, materials)
READ_WRITE(vec4, velocities)
READ_WRITE(vec4, predicted)

layout(push_constant, scalar) uniform Constants { Push push; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 x = positions[i];
  if (x.w == 0) return;
  const vec4 v = velocities[i];
  const Material material = materials[floatBitsToUint(v.w)];
  const vec3 driven = driven_velocity(v.xyz, push.gravity, material.keep, push.h);
  velocities[i].xyz = driven;
  predicted[i].xyz = predicted_position(x.xyz, driven, push.h);
}
