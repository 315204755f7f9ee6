// search: finds in the grid the primitives whose boxes overlap the thread's own, and lists them to be looked at more closely.
//
// Threads run in step: what one of them does with a primitive that it has found, all of them wait for. So the search does no more
// than tell far from near, and the pairs that are near are looked at one a thread in the passes after it (pair.glsl). Loops alone
// skip work on such a machine; a branch that nobody takes may still cost as much as one that is taken.

#include "contact/grid.glsl"

GATHER_UINT(grid_starts)
GATHER(grid_entries)
READ_WRITE(uint, leashes)

// The thread's own, as in Outline.
vec4 path;    // w: the step
float away;

struct Search {
  vec3 middle, half_sides;   // m
  vec3 near;                 // m: no box of the level whose middle is farther away overlaps
  uint kind, level;
  // Among primitives of one kind and level each pair would be found from both: the one whose cell comes first (by z, then y, then
  // x), or in one cell the one with the lower number, finds it.
  bool among_equals;
  ivec3 own_cell;
  uint own_number;
};

// Whether the thread's primitive may meet one whose half sides these are. They were m apart, middle from middle, at the detection;
// `slack`: by how much more than that their particles can get closer, the distance to keep included (m).
bool may_meet(vec3 m, vec3 half_size, float slack);

// The four particles of the pair; WEFT_NONE first where the two share one.
uvec4 particles_with(uint primitive);
void put_near(uint place, uint primitive);

uint number_of(vec4 entry) { return floatBitsToUint(entry.w) & primitive_mask; }

bool comes_before(ivec3 a, ivec3 b) { return a.z != b.z ? a.z < b.z : a.y != b.y ? a.y < b.y : a.x < b.x; }

// A pair that finds no place cannot be kept apart: its particles are held where they are.
void add_near(uint kind, uint primitive, uvec4 particle) {
  const uint place = atomicAdd(detection[0].near[kind], 1u);
  const bool lost = place >= WEFT_NEAR * contact_settings.capacity;
  if (!lost) put_near(place, primitive);
  for (uint k = lost ? 0 : 4; k < 4; ++k) atomicMin(leashes[k < 2 ? (k == 0 ? particle.x : particle.y) : k == 2 ? particle.z : particle.w], 0u);
}

// `row`: y and z of the cells that are gone through.
void visit(Search search, uint k, bool any_row, ivec2 row) {
  const vec4 entry = FETCH(grid_entries, 3 * k);
  const vec3 m = entry.xyz - search.middle;
  if (any(greaterThan(abs(m), search.near))) return;
  const uint bits = floatBitsToUint(entry.w), primitive = number_of(entry);
  if (bits >> level_shift != search.level || (primitive >= contact_settings.triangles ? of_edges : of_triangles) != search.kind) return;
  const ivec3 cell = cell_at(entry.xyz, search.level);
  if (!any_row && cell.yz != row) return;
  if (search.among_equals && (cell == search.own_cell ? primitive <= search.own_number : comes_before(cell, search.own_cell))) return;
  const vec4 its_outline = FETCH(grid_entries, 3 * k + 1), its_path = FETCH(grid_entries, 3 * k + 2);
  const vec3 relative = its_path.xyz - path.xyz;
  // pair.glsl, with the largest that its terms can be.
  const float slack = (1 + rounding) * (away + its_outline.w + length(relative) + max(path.w, its_path.w));
  if (!may_meet(m - 0.5 * relative, its_outline.xyz, slack)) return;
  const uvec4 particle = particles_with(primitive);
  if (particle.x != WEFT_NONE) add_near(search.kind, primitive, particle);
}

// A row of cells is one run of entries, those of other rows among them that share its slots.
uvec2 run_of(Search search, int first, int last, ivec2 row) {
  const uint from = slot_of(ivec3(first, row), search.level, search.kind), to = slot_of(ivec3(last, row), search.level, search.kind);
  return uvec2(FETCH_UINT(grid_starts, from), FETCH_UINT(grid_starts, to + 1) + (to < from ? contact_settings.triangles + contact_settings.edges : 0));
}

// Where a level has more cells in question than there are primitives (a fast vertex among small triangles, a triangle too large for
// the last level) or slots, the primitives are gone through instead.
void search_level(Search search) {
  const uint primitives = contact_settings.triangles + contact_settings.edges;
  ivec3 first = cell_at(search.middle - search.near, search.level), last = cell_at(search.middle + search.near, search.level);
  const vec3 cells = vec3(last) - vec3(first) + 1;
  const bool all_entries = cells.x * cells.y * cells.z >= float(min(primitives, contact_settings.slots));
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

// Finds all primitives of a kind whose boxes may overlap. `own_number`: of a primitive of that kind itself, which leaves those on
// lower levels to find it; WEFT_NONE for a vertex.
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
