// grid_fill: puts every cluster into its bucket. A bucket's count falls back to zero on the way, ready for the next detection. The order
// of entries within a bucket depends on the order of threads; nothing else does.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(cluster_boxes)
READ_WRITE(uint, grid_counts)
READ(Detection, detection)
GATHER_UINT(grid_starts)
WRITE(vec4, grid_entries)

#include "contact/cluster.glsl"

// push.count: clusters.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const Place place = place_of(Box(FETCH(cluster_boxes, 2 * i).xyz, FETCH(cluster_boxes, 2 * i + 1).xyz));
  const uint left = atomicAdd(grid_counts[place.bucket], 0xffffffffu);
  grid_entries[FETCH_UINT(grid_starts, place.bucket) + left - 1] = vec4(place.middle, uintBitsToFloat(i | place.level << level_shift));
}
