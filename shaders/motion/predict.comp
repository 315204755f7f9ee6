// predict: where every particle would go in the frame's first substep if nothing held it (symplectic Euler).
// The predictions of later substeps are made where the one before ends (update_velocity.glsl). An anchor stays.
// With contacts it also watches whether a prediction strays (leash.glsl); the anchor pass does so for anchors.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
#include "motion/motion.glsl"

GATHER(positions)
GATHER(materials)
GATHER_WRITE(velocities)
WRITE(vec4, predicted)

READ_WRITE(Detection, detection)
#include "contact/leash.glsl"

vec3 free_flight(uint i, vec3 x) {
  const vec4 v = FETCH(velocities, i);
  const float keep = FETCH(materials, floatBitsToUint(v.w)).x;
  const vec3 driven = driven_velocity(v.xyz, motion.gravity, keep, motion.h);
  velocities[i].xyz = driven;
  return predicted_position(x, driven, motion.h);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 x = FETCH(positions, i);
  if (x.w == 0) return;
  const vec3 p = free_flight(i, x.xyz);
  predicted[i].xyz = p;
  if (has_contacts && strays(p, expected_at(i, detection[0].age + 2), detection[0].reach)) detection[0].due = 1;
}
