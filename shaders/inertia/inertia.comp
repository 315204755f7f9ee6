// inertia: takes out what particles feel of the motion of the frame that their cloth goes with, once a frame. Where that frame moves by
// rigid maps, what it carries has the velocity u(x) to its next place. As a map of velocities, w + M w + N (x - centre) + b, the host tells
// how u has changed since the frame before, times the parts that are taken out (engine/effects/inertia/inertia.cpp has the formulas).
//
// It comes before the prediction, which is made of these velocities.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(materials)
GATHER_WRITE(velocities)
READ(FrameChange, frame_changes)
#include "motion/body.glsl"

// push.count: particles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec4 x = FETCH(positions, i), w = FETCH(velocities, i);
  if (x.w == 0) return;
  const FrameChange change = frame_changes[body_of(i)];
  const vec3 r = x.xyz - unpack(change.centre);
  vec3 dv = unpack(change.b);
  for (int k = 0; k < 3; ++k) dv[k] += dot(unpack(change.m[k]), w.xyz) + dot(unpack(change.n[k]), r);
  if (dot(dv, dv) < 1e20) velocities[i].xyz = w.xyz + dv;   // and finite
}
