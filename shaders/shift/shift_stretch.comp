// shift_stretch: the shifts of links that Jacobi solves beside strands (shift.glsl), and their rest lengths with these. Both ends of a link
// have it, and find the same.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(velocities)
GATHER_UINT4(stretch_shifted)
GATHER_WRITE_UINT(stretch_shifts)
WRITE(uvec4, stretch_links)
#include "shift/shift.glsl"

void main() {
  const uint k = gl_GlobalInvocationID.x;
  if (k >= push.count) return;
  const ShiftedLink link = unpack_shifted_link(FETCH(stretch_shifted, k));
  if (link.rest == 0) return;
  const float shift = shift_of(link, FETCH_UINT(stretch_shifts, k));
  stretch_shifts[k] = floatBitsToUint(shift);
  const uint shifted = with_rest(link, link.rest - shift);
  if ((k & 1u) == 0)
    stretch_links[k >> 1].y = shifted;
  else
    stretch_links[k >> 1].w = shifted;
}
