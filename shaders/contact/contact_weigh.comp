// contact_weigh: adds up what the contacts of each particle lack, by which they then share its mass (contact_share.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(uint, contact_lacks)

#include "contact/contact_share.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= detection[0].listings[WEFT_TOUCHING]) return;
  const Touch touch = touch_at(place);
  if (!touch.pushes) return;
  for (int j = 0; j < 4; ++j) {
    const uint i = touch.pair.particle[j];
    if (touch.weights[j] != 0 && FETCH(positions, i).w != 0) atomicAdd(contact_lacks[i], lack_of(touch.weights[j], touch.depth, FETCH_UINT(contact_counts, i)));
  }
}
