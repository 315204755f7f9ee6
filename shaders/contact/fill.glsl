// fill: what grid_fill does, with all threads of a workgroup. Needs contact/grid.glsl, contact/cluster.glsl, contact/scan.glsl, wait() and
// the buffers.

Place place_at(uint cluster) {
  return place_of(Box(LATEST(cluster_boxes, 2 * cluster).xyz, LATEST(cluster_boxes, 2 * cluster + 1).xyz));
}

void count(Place place) {
  atomicAdd(grid_counts[place.bucket], 1u);
  // Bits of floats that are not negative order like integers. Most boxes are no longer than the longest so far, and need no atomic.
  const uint bits = floatBitsToUint(place.half_side);
  if (detection[0].extents[place.level] < bits) {
    atomicMax(detection[0].extents[place.level], bits);
    atomicOr(detection[0].levels, 1u << place.level);
  }
}

// Every thread has a run of buckets.
void find_starts(uint thread) {
  const uint buckets = contact_settings.buckets, run = (buckets + workgroup - 1) / workgroup;
  const uint first = min(thread * run, buckets), end = min(first + run, buckets);
  uint sum = 0;
  for (uint k = first; k < end; ++k) sum += grid_counts[k];
  uint start = sum_before_thread(sum);
  for (uint k = first; k < end; ++k) {
    grid_starts[k] = start;
    start += grid_counts[k];
  }
  if (first < end && end == buckets) grid_starts[end] = start;
}

void enter(uint cluster) {
  const Place place = place_at(cluster);
  const uint left = atomicAdd(grid_counts[place.bucket], 0xffffffffu);
  grid_entries[grid_starts[place.bucket] + left - 1] = vec4(place.middle, uintBitsToFloat(cluster | place.level << level_shift));
}

void fill(uint thread, uint clusters) {
  for (uint k = thread; k < clusters; k += workgroup) count(place_at(k));
  wait();
  find_starts(thread);
  wait();
  for (uint k = thread; k < clusters; k += workgroup) enter(k);
}
