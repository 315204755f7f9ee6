// shift_strands: the shifts of links that strands solve (shift.glsl), and their rest lengths with these.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(velocities)
GATHER_UINT4(strand_shifted)
GATHER_WRITE_UINT(strand_shifts)
WRITE(uvec2, strand_links)
#include "shift/shift.glsl"

void main() {
  const uint k = gl_GlobalInvocationID.x;
  if (k >= push.count) return;
  const ShiftedLink link = unpack_shifted_link(FETCH(strand_shifted, k));
  if (link.rest == 0) return;
  const float shift = shift_of(link, FETCH_UINT(strand_shifts, k));
  strand_shifts[k] = floatBitsToUint(shift);
  strand_links[k].y = with_rest(link, link.rest - shift);
}
