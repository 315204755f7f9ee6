// grid_fill: puts every primitive into its bucket. A bucket's count falls back to zero on the way, ready for the next detection. The order
// of entries within a bucket depends on the order of threads; nothing else does.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(uint, grid_counts)
READ(Detection, detection)
GATHER_UINT(grid_starts)
WRITE(vec4, grid_entries)

#include "contact/primitive.glsl"

// push.count: triangles, then edges.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const Place place = place_of(i);
  const uint left = atomicAdd(grid_counts[place.bucket], 0xffffffffu);
  const uint entry = 3 * (FETCH_UINT(grid_starts, place.bucket) + left - 1);
  grid_entries[entry] = vec4(place.middle, uintBitsToFloat(i | place.level << level_shift));
  Outline outline;
  if (i < contact_settings.triangles) outline = outline_of_triangle(i);
  else outline = outline_of_edge(i - contact_settings.triangles);
  grid_entries[entry + 1] = vec4(outline.half_sides, outline.away);
  grid_entries[entry + 2] = vec4(outline.trajectory, outline.step);
}
