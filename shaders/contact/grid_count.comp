// grid_count: counts the primitives of every bucket of the grid, and finds the longest box on each level.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(uint, grid_counts)
READ_WRITE(Detection, detection)

#include "contact/primitive.glsl"

// push.count: triangles, then edges.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const Place place = place_of(i);
  atomicAdd(grid_counts[place.bucket], 1u);
  // Bits of floats that are not negative order like integers. Most boxes are no longer than the longest so far, and need no atomic.
  const uint bits = floatBitsToUint(place.half_side);
  if (detection[0].extents[place.kind * WEFT_LEVELS + place.level] < bits) {
    atomicMax(detection[0].extents[place.kind * WEFT_LEVELS + place.level], bits);
    atomicOr(detection[0].levels[place.kind], 1u << place.level);
  }
}
