// search: broad phase. Finds in the grid the primitives whose boxes overlap the thread's own, and lists these pairs for the narrow phase.
//
// SIMD divergence: threads of a group run in step, and all of them wait while one of them tests a primitive that it has found. So the
// search makes only a cheap test, and the pairs that pass it are tested exactly, one a thread, in passes of their own (pair.glsl). Only
// loop bounds skip work on such a machine; a branch may cost as much as if it were taken.

#include "contact/grid.glsl"

GATHER_UINT(grid_starts)
GATHER(grid_entries)
READ_WRITE(uint, displacement_bounds)

// The thread's own primitive, as in Outline.
vec4 trajectory;    // w: the step
float away;

struct Search {
  vec3 middle, half_sides;   // m
  vec3 near;                 // m: no box of the level overlaps whose middle is farther away
  uint kind, level;
  // Two primitives of one kind and level would find each other. Only the one whose cell comes first (by z, then y, then x) does, or, in one
  // cell, the one with the lower number.
  bool among_equals;
  ivec3 own_cell;
  uint own_number;
};

// Whether the thread's primitive may meet one with these half sides. m leads from middle to middle as at the detection; `slack`: by how
// much closer their particles can come, plus the separation (m).
bool may_meet(vec3 m, vec3 half_size, float slack);

// The four particles of the pair; WEFT_NONE first where the two share one.
uvec4 particles_with(uint primitive);
void put_near(uint place, uint primitive);

uint number_of(vec4 entry) { return floatBitsToUint(entry.w) & primitive_mask; }

bool comes_before(ivec3 a, ivec3 b) { return a.z != b.z ? a.z < b.z : a.y != b.y ? a.y < b.y : a.x < b.x; }

// A pair beyond the capacity overflows: its particles are held in place, by a displacement bound of 0.
void add_near(uint kind, uint primitive, uvec4 particle) {
  const uint place = atomicAdd(detection[0].near[kind], 1u);
  const bool overflows = place >= WEFT_NEAR * contact_settings.capacity;
  if (!overflows) put_near(place, primitive);
  for (uint k = overflows ? 0 : 4; k < 4; ++k)
    atomicMin(displacement_bounds[k < 2 ? (k == 0 ? particle.x : particle.y) : k == 2 ? particle.z : particle.w], 0u);
}

// Tests entry k. `row`: y and z of the cells that are visited.
void visit(Search search, uint k, bool any_row, ivec2 row) {
  const vec4 entry = FETCH(grid_entries, 3 * k);
  const vec3 m = entry.xyz - search.middle;
  if (any(greaterThan(abs(m), search.near))) return;
  const uint bits = floatBitsToUint(entry.w), primitive = number_of(entry);
  if (bits >> level_shift != search.level || (primitive >= contact_settings.triangles ? of_edges : of_triangles) != search.kind) return;
  const ivec3 cell = cell_at(entry.xyz, search.level);
  if (!any_row && cell.yz != row) return;
  if (search.among_equals && (cell == search.own_cell ? primitive <= search.own_number : comes_before(cell, search.own_cell))) return;
  const vec4 its_outline = FETCH(grid_entries, 3 * k + 1), its_trajectory = FETCH(grid_entries, 3 * k + 2);
  const vec3 relative = its_trajectory.xyz - trajectory.xyz;
  // The bound of pair.glsl, with the largest values of its terms.
  const float slack = (1 + rounding) * (away + its_outline.w + length(relative) + max(trajectory.w, its_trajectory.w));
  if (!may_meet(m - 0.5 * relative, its_outline.xyz, slack)) return;
  const uvec4 particle = particles_with(primitive);
  if (particle.x != WEFT_NONE) add_near(search.kind, primitive, particle);
}

// The entries of a row of cells are one run; among them are those of other rows that share its buckets.
uvec2 run_of(Search search, int first, int last, ivec2 row) {
  const uint from = bucket_of(ivec3(first, row), search.level, search.kind), to = bucket_of(ivec3(last, row), search.level, search.kind);
  return uvec2(FETCH_UINT(grid_starts, from),
               FETCH_UINT(grid_starts, to + 1) + (to < from ? contact_settings.triangles + contact_settings.edges : 0));
}

// Visits the cells of a level that the search's box overlaps. Where these are more than there are primitives (a fast vertex among small
// triangles, a triangle too large for the last level) or buckets, it visits all primitives instead.
void search_level(Search search) {
  const uint primitives = contact_settings.triangles + contact_settings.edges;
  ivec3 first = cell_at(search.middle - search.near, search.level), last = cell_at(search.middle + search.near, search.level);
  const vec3 cells = vec3(last) - vec3(first) + 1;
  const bool all_entries = cells.x * cells.y * cells.z >= float(min(primitives, contact_settings.buckets));
  const ivec3 own = search.own_cell;
  const bool half_of_them = search.among_equals && !all_entries;
  if (half_of_them) first.z = own.z;
  if (all_entries) last = first;
  for (int z = first.z; z <= last.z; ++z)
    for (int y = half_of_them && z == own.z ? own.y : first.y; y <= last.y; ++y) {
      const ivec2 row = ivec2(y, z);
      const uvec2 run = all_entries ? uvec2(0, primitives) : run_of(search, half_of_them && row == own.yz ? own.x : first.x, last.x, row);
      for (uint k = run.x; k < run.y; ++k) visit(search, k < primitives ? k : k - primitives, all_entries, row);
    }
}

// Finds all primitives of a kind whose boxes may overlap. `own_number`: that of the searching primitive if it is of that kind itself: then
// primitives on lower levels find it, not it them. WEFT_NONE for a vertex.
void search(Sweep sweep, uint kind, uint own_number) {
  const vec3 half_size = half_sides(sweep);
  const uint own_level = own_number == WEFT_NONE ? 0 : level_of(max(half_size.x, max(half_size.y, half_size.z)));
  Search search = Search(middle_of(sweep), (1 + rounding) * half_size, vec3(0), kind, own_level, false, ivec3(0), own_number);
  search.own_cell = cell_at(search.middle, own_level);
  for (uint levels = detection[0].levels[kind] >> own_level << own_level; levels != 0; levels &= levels - 1) {
    search.level = uint(findLSB(levels));
    search.among_equals = own_number != WEFT_NONE && search.level == own_level;
    search.near = search.half_sides + uintBitsToFloat(detection[0].extents[kind * WEFT_LEVELS + search.level]);
    search_level(search);
  }
}
