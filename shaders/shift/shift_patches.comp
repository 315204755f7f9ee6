// shift_patches: the shifts of links that Gauss-Seidel solves in patches (shift.glsl), and their rest lengths with these.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(velocities)
GATHER_UINT4(patch_shifted)
GATHER_WRITE_UINT(patch_shifts)
WRITE(uvec2, patch_links)
#include "shift/shift.glsl"

void main() {
  const uint k = gl_GlobalInvocationID.x;
  if (k >= push.count) return;
  const ShiftedLink link = unpack_shifted_link(FETCH(patch_shifted, k));
  const float shift = shift_of(link, FETCH_UINT(patch_shifts, k));
  patch_shifts[k] = floatBitsToUint(shift);
  patch_links[k].y = (floatBitsToUint(link.rest - shift) & 0xfffffffeu) | link.low;
}
