// contact_penetration: sums the penetration of each particle's active contacts, by which they then share its mass (contact_share.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(uint, contact_penetrations)

#include "contact/contact_share.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= detection[0].listings[WEFT_ACTIVE]) return;
  const ActiveContact contact = active_contact_at(place);
  if (!contact.penetrates) return;
  for (int j = 0; j < 4; ++j) {
    const uint i = contact.pair.particle[j];
    if (contact.weights[j] != 0 && FETCH(positions, i).w != 0)
      atomicAdd(contact_penetrations[i], penetration_of(contact.weights[j], contact.depth, FETCH_UINT(contact_counts, i)));
  }
}
