// contact_prepare: a candidate's normal, barycentric weights and separation for this substep. All of it is taken from the pose in which the
// substep began, where the sides are known to be apart, so that the normal points to the right side however far the prediction penetrates
// (Lewin 2018, "Cloth self collision with predictive contacts").
//
// A pair that is closer than its separation is parted at a bounded speed: a substep asks for at most contact_settings.recover more than
// its present gap. A pair that does not come near in this substep is not active: it gets no share of its particles' masses, and its
// contact_normals.w is -height, the negative height of particle 0 over the middle of the gap (contact_unsafe), instead of the separation.
// A pair whose sides touch or overlap has no direction: its normal is 0, and contact_limit holds its particles.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER_UINT(displacement_bounds)
READ_WRITE(Detection, detection)

#include "contact/apart.glsl"
#include "contact/proximity.glsl"
#include "contact/contact.glsl"
#include "contact/prepare.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < min(detection[0].candidates, contact_settings.capacity)) prepare(i);
}
