// grid_scan: second half of the exclusive scan: where every bucket's entries start. A workgroup adds up the totals of the blocks before its
// own, then scans its own buckets. The place after the last bucket holds the number of all entries.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(uint, grid_counts)
READ(uint, grid_totals)
WRITE(uint, grid_starts)

#include "contact/scan.glsl"

uint entries_before_block() {
  uint sum = 0;
  for (uint k = gl_LocalInvocationID.x; k < gl_WorkGroupID.x; k += gl_WorkGroupSize.x) sum += grid_totals[k];
  return sum_of_group(sum);
}

void main() {
  const uint first = gl_GlobalInvocationID.x * buckets_per_thread;
  const uint end = min(first + buckets_per_thread, contact_settings.buckets);
  uint sum = 0;
  for (uint k = first; k < end; ++k) sum += grid_counts[k];
  uint start = entries_before_block() + sum_before_thread(sum);
  for (uint k = first; k < end; ++k) {
    grid_starts[k] = start;
    start += grid_counts[k];
  }
  if (first < end && end == contact_settings.buckets) grid_starts[end] = start;
}
