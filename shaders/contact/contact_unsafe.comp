// contact_unsafe: lists the unsafe candidates, those that could cross at the substep's end, for contact_limit. All others, nearly all, keep
// to their own sides of the plane in the middle of their gap, whatever step fractions their particles take.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER(contact_weights)
READ_WRITE(Detection, detection)
WRITE(uint, contact_list)

#define ITERATE(i) FETCH(predicted, i)
#include "contact/contact.glsl"
#include "contact/list_places.glsl"
#include "contact/contact_list.glsl"
#include "contact/unsafe.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < min(detection[0].candidates, contact_settings.capacity) && is_unsafe(i)) list(WEFT_UNSAFE, i);
}
