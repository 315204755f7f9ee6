// grid_total: first half of the exclusive scan: sums the counts of every workgroup's block of buckets.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(uint, grid_counts)
WRITE(uint, grid_totals)

#include "contact/scan.glsl"

void main() {
  const uint first = gl_GlobalInvocationID.x * buckets_per_thread;
  uint sum = 0;
  for (uint k = first; k < min(first + buckets_per_thread, contact_settings.buckets); ++k) sum += grid_counts[k];
  const uint total = sum_of_group(sum);
  if (gl_LocalInvocationID.x == 0) grid_totals[gl_WorkGroupID.x] = total;
}
