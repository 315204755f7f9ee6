// grid: boxes that particles cannot leave before the next detection, and a spatial hash of the clusters' boxes with a level for every size
// (Teschner et al. 2003, "Optimized spatial hashing", with the levels of a hierarchical grid).
//
// A box belongs to the cell that holds its middle, on the first level whose cells are at least as long as it (cell * 2^level). A search on
// a level widens its own box by the longest half side there, so that one cell a cluster is enough; on the searching box's level or above
// that is at most three cells along each axis. Cells of any level that hash alike share a bucket: an entry counts only in the cell and on
// the level that are its own.
//
// Boxes and cells are `precise`: counting, filling and searching must agree to the bit. Needs push and detection.

GATHER(rest)

// Four units in the last place of the largest coordinate: rounding errors of sums of trajectories and of comparisons.
const float rounding = 4.0 / 8388608.0;

float per_substep() { return 1.0 / float(max(detection[0].lifetime, 1)); }

const uint of_triangles = 0, of_edges = 1;   // kinds of pairs

// The position of a particle at the last detection, its predicted trajectory from there over the candidate lifetime, and its displacement
// bound (m).
struct Track {
  vec3 at, trajectory;
  float bound;
};

struct Sweep {
  vec3 low, high;    // corners of the box that the primitive's surface cannot leave (m)
  float clearance;   // how far a particle can be from its place on its trajectory (m)
};

Sweep sweep_of(vec3 low, vec3 high, float bound, float thickness) {
  const vec3 far = max(abs(low), abs(high));
  precise const float clearance = bound + rounding * max(far.x, max(far.y, far.z));
  precise const float margin = clearance + 0.5 * thickness;
  precise const vec3 from = low - margin, to = high + margin;
  return Sweep(from, to, clearance);
}

vec3 end_of(Track track) {
  precise const vec3 end = track.at + track.trajectory;
  return end;
}

Sweep sweep_of(Track a, float thickness) {
  const vec3 end = end_of(a);
  return sweep_of(min(a.at, end), max(a.at, end), a.bound, thickness);
}

Sweep sweep_of(Track a, Track b, float thickness) {
  const vec3 c = end_of(a), d = end_of(b);
  return sweep_of(min(min(a.at, b.at), min(c, d)), max(max(a.at, b.at), max(c, d)), max(a.bound, b.bound), thickness);
}

Sweep sweep_of(Track a, Track b, Track c, float thickness) {
  const vec3 d = end_of(a), e = end_of(b), f = end_of(c);
  return sweep_of(min(min(min(a.at, b.at), c.at), min(min(d, e), f)), max(max(max(a.at, b.at), c.at), max(max(d, e), f)),
                  max(max(a.bound, b.bound), c.bound), thickness);
}

uint level_of(float half_side) {
  uint level = 0;
  for (float size = contact_settings.cell; level < WEFT_LEVELS - 1 && size < 2 * half_side; size *= 2) ++level;
  return level;
}

// Clamped far outside of any scene, where a cell's number would no longer be an integer of 32 bits.
ivec3 cell_at(vec3 x, uint level) {
  precise const float inverse = (1.0 / contact_settings.cell) * uintBitsToFloat((127 - level) << 23);   // 2^-level
  precise const vec3 scaled = x * (inverse * vec3(4, 1, 1));
  return ivec3(clamp(floor(scaled), -1e9, 1e9));
}

// Successive cells along x have successive buckets (the first follows the last), so that a row of cells is one run of entries. The hash
// mixes its bits, so that neighbouring rows overlap no more often than random ones, whatever the number of buckets.
uint bucket_of(ivec3 cell, uint level) {
  uint hash = uint(cell.y) * 19349663u + uint(cell.z) * 83492791u + level * 2654435761u;
  hash = (hash ^ (hash >> 15)) * 739982445u;
  return ((hash ^ (hash >> 13)) + uint(cell.x)) & (contact_settings.buckets - 1);
}

// An entry's number: the cluster, and its level in the top four bits. Bit 27 is never set, so these are never a NaN's bits.
const uint level_shift = 28;
const uint cluster_mask = 0x0fffffff;
