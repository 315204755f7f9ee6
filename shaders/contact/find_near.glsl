// find_near: what grid_search does for a cluster. Needs contact/grid.glsl, contact/cluster.glsl, contact/smooth.glsl and the buffers.

struct Search {
  vec3 middle, near;   // m: no box of the level overlaps whose middle is farther away than `near`
  uint level;
  // Two clusters of one level would find each other. Only the one whose cell comes first (by z, then y, then x) does, or, in one cell, the
  // one with the lower number.
  bool among_equals;
  ivec3 own_cell;
};

uint own;
Box own_box;

bool comes_before(ivec3 a, ivec3 b) { return a.z != b.z ? a.z < b.z : a.y != b.y ? a.y < b.y : a.x < b.x; }

void add_near(uint cluster, uint other) {
  const uint row = (WEFT_NEAR_CLUSTERS + 1) * cluster;
  const uint place = atomicAdd(near_clusters[row], 1u);
  if (place < WEFT_NEAR_CLUSTERS) near_clusters[row + 1 + place] = other;
}

// How far `cluster` may have to go in a substep to be out of the way of the kinematic particles of another one.
void make_way(uint cluster, uint by) {
  if (LATEST(cluster_motions, WEFT_MOTION * by + 7).y == 0) return;
  const vec3 approach = LATEST(cluster_motions, WEFT_MOTION * by + 6).xyz - LATEST(cluster_motions, WEFT_MOTION * cluster + 6).xyz;
  const float pushed = min(per_substep() * length(approach), detection[0].most_pushed);
  if (pushed > contact_settings.margin_low) atomicMax(cluster_pushes[cluster], floatBitsToUint(pushed));
}

// Whether entry k is to be listed. `row`: y and z of the cells that are visited.
bool is_near(Search search, uint k, bool any_row, ivec2 row, out uint other) {
  const vec4 entry = LATEST(grid_entries, k);
  const uint bits = floatBitsToUint(entry.w);
  other = bits & cluster_mask;
  const ivec3 cell = cell_at(entry.xyz, search.level);
  const bool in_row = any_row || cell.yz == row;
  const bool is_other = !search.among_equals || (cell == search.own_cell ? other > own : !comes_before(cell, search.own_cell));
  const vec3 low = LATEST(cluster_boxes, 2 * other).xyz, high = LATEST(cluster_boxes, 2 * other + 1).xyz;
  return bits >> level_shift == search.level && in_row && is_other && !any(greaterThan(abs(entry.xyz - search.middle), search.near)) &&
         !any(greaterThan(low, own_box.high)) && !any(lessThan(high, own_box.low));
}

void list_both(uint other) {
  const uint mark = touch(own, other) ? WEFT_TOUCHING : 0;
  add_near(own, other | mark);
  add_near(other, own | mark);
  if (detection[0].most_pushed == 0) return;
  make_way(own, other);
  make_way(other, own);
}

// The entries of a row of cells are one run; among them are those of other rows that share its buckets.
uvec2 run_of(Search search, int first, int last, ivec2 row) {
  const uint from = bucket_of(ivec3(first, row), search.level), to = bucket_of(ivec3(last, row), search.level);
  const uint wrapped = to < from ? contact_settings.clusters : 0;
  return uvec2(LATEST_UINT(grid_starts, from), LATEST_UINT(grid_starts, to + 1) + wrapped);
}

// Visits the cells of a level that the search's box overlaps. Where these are more than there are clusters (a fast one among small ones,
// one too large for the last level) or buckets, it visits all clusters instead.
void search_level(Search search) {
  const uint clusters = contact_settings.clusters;
  ivec3 first = cell_at(search.middle - search.near, search.level), last = cell_at(search.middle + search.near, search.level);
  const vec3 cells = vec3(last) - vec3(first) + 1;
  const bool all_entries = cells.x * cells.y * cells.z >= float(min(clusters, contact_settings.buckets));
  const ivec3 own_cell = search.own_cell;
  const bool half_of_them = search.among_equals && !all_entries;
  if (half_of_them) first.z = own_cell.z;
  if (all_entries) last = first;
  for (int z = first.z; z <= last.z; ++z)
    for (int y = half_of_them && z == own_cell.z ? own_cell.y : first.y; y <= last.y; ++y) {
      const ivec2 row = ivec2(y, z);
      const int from = half_of_them && row == own_cell.yz ? own_cell.x : first.x;
      const uvec2 run = all_entries ? uvec2(0, clusters) : run_of(search, from, last.x, row);
      for (uint k = run.x; k < run.y; ++k) {
        uint other = 0;
        for (bool found = false; !found && k < run.y; k += uint(!found))
          found = is_near(search, k < clusters ? k : k - clusters, all_entries, row, other);
        if (k >= run.y) break;
        list_both(other);
      }
    }
}

void find_near(uint cluster) {
  own = cluster;
  own_box = box_at(own);
  const Place place = place_of(own_box);
  add_near(own, own | WEFT_TOUCHING);
  smooth_clusters[own] = uint(is_smooth(own));
  const vec3 half_size = (1 + rounding) * (0.5 * (own_box.high - own_box.low));
  for (uint levels = detection[0].levels >> place.level << place.level; levels != 0; levels &= levels - 1) {
    const uint level = uint(findLSB(levels));
    const vec3 near = half_size + uintBitsToFloat(detection[0].extents[level]);
    search_level(Search(place.middle, near, level, level == place.level, cell_at(place.middle, place.level)));
  }
}
