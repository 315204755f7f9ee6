// contact_penetration: sums the penetration of each particle's active contacts, by which they then share its mass (contact_share.glsl), and
// lists those that penetrate, a few in a hundred, for contact_solve.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER(contact_weights)
GATHER_UINT(contact_counts)
GATHER_WRITE_UINT(contact_list)
READ_WRITE(Detection, detection)
READ_WRITE(uint, contact_penetrations)

#include "contact/list_places.glsl"
#include "contact/wide.glsl"
#include "contact/contact.glsl"
#include "contact/contact_share.glsl"
#include "contact/penetration.glsl"
#include "contact/contact_list.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= detection[0].listings[WEFT_ACTIVE]) return;
  const uint i = LISTED(WEFT_ACTIVE, place);
  if (add_penetrations(i)) list(WEFT_PENETRATING, i);
}
