// pair: the search for what a primitive may meet before the next detection, and the candidates that come of it.
//
// A substep takes a particle from within its clearance of its path to within that again, or stops it on the straight line
// between: there it is that close to a place of its path that it passes in this substep, t of a step behind. Two points of A
// and B are mixtures of such particles, so in s substeps their paths bring them closer by at most the largest of
//     |s (q_i - q_j) - (t_i q_i - t_j q_j)| / H    for a path q_i of A and q_j of B, 0 <= t <= 1 and 1 <= s <= H,
// which is convex in each t. At t_i = t_j = 0 or 1 it is at most u, the largest |q_i - q_j|; at 1 and 0 it is
//     |(s - 1) (q_i - q_j) - q_j| / H <= (1 - 1/H) u + |q_j| / H,
// and at 0 and 1 the same with q_i. So A and B, d apart at the detection, cannot meet before the next one if
//     d - u - max(0, max(step_A, step_B) - u / H) - clearance_A - clearance_B >= keep.
// Nor can they if their boxes do not overlap: a place that a path passes is in its box. A pair that stays together wherever it
// goes has u = 0, and only the step by which one of them may be stopped counts.

#include "grid.glsl"
#include "proximity.glsl"

GATHER(positions)
GATHER(velocities)
GATHER_UINT(grid_starts)
GATHER(grid_entries)
WRITE(uvec4, candidates)
READ_WRITE(uint, leashes)

// What the pass does with a primitive whose box overlaps, and what it asks before: whether one whose middle is at m from its own
// may come near enough, by the entry's third part. Neighbouring threads run in step, so that one that meets keeps all of them waiting.
void meet(uint primitive);
bool may_reach(vec3 m, uint third);

struct Search {
  vec3 middle, half_sides;   // m
  uint kind, level;
  // Among primitives of one kind and level each pair would be found from both: the one whose cell comes first, or in one cell
  // the one with the lower number, finds it.
  bool among_equals;
  ivec3 own_cell;
  uint own_number;
};

uint number_of(vec4 entry) { return floatBitsToUint(entry.w) & primitive_mask; }

bool comes_before(ivec3 a, ivec3 b) { return a.z != b.z ? a.z < b.z : a.y != b.y ? a.y < b.y : a.x < b.x; }

void visit(Search search, vec4 entry, uint k) {
  const uint bits = floatBitsToUint(entry.w);
  const uint primitive = number_of(entry);
  const uint its_kind = primitive >= push.triangles ? of_edges : of_triangles;
  const vec3 near = search.half_sides + FETCH(grid_entries, 3 * k + 1).xyz;
  if (bits >> level_shift != search.level || its_kind != search.kind || !all(lessThanEqual(abs(entry.xyz - search.middle), near))) return;
  if (may_reach(entry.xyz - search.middle, 3 * k + 2)) meet(primitive);
}

void go_through(Search search, uint k) {
  const vec4 entry = FETCH(grid_entries, 3 * k);
  if (!search.among_equals || number_of(entry) > search.own_number) visit(search, entry, k);
}

void search_cells(Search search, ivec3 first, ivec3 last) {
  for (int z = search.among_equals ? search.own_cell.z : first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        const ivec3 cell = ivec3(x, y, z);
        if (search.among_equals && comes_before(cell, search.own_cell)) continue;
        const uint slot = slot_of(cell, search.level, search.kind);
        const uint end = FETCH_UINT(grid_starts, slot + 1);
        for (uint k = FETCH_UINT(grid_starts, slot); k < end; ++k) {
          const vec4 entry = FETCH(grid_entries, 3 * k);
          if (cell_at(entry.xyz, search.level) == cell && !(search.among_equals && cell == search.own_cell && number_of(entry) <= search.own_number))
            visit(search, entry, k);
        }
      }
}

// Meets all primitives of a kind whose boxes may overlap. `own_number`: of a primitive of that kind itself, which leaves those on
// lower levels to find it; WEFT_NONE for a vertex. Where a level has more cells in question than there are primitives (a fast
// vertex among small triangles, a triangle too large for the last level), the primitives are gone through instead.
void search(Sweep sweep, uint kind, uint own_number) {
  const uint primitives = push.triangles + push.edges;
  const vec3 half_size = half_sides(sweep);
  const uint own_level = own_number == WEFT_NONE ? 0 : level_of(max(half_size.x, max(half_size.y, half_size.z)));
  Search search = Search(middle_of(sweep), (1 + rounding) * half_size, kind, own_level, own_number != WEFT_NONE, ivec3(0), own_number);
  search.own_cell = cell_at(search.middle, own_level);
  for (; search.level < WEFT_LEVELS; ++search.level, search.among_equals = false) {
    const float extent = uintBitsToFloat(detection[0].extents[kind * WEFT_LEVELS + search.level]);
    if (extent <= 0) continue;
    const vec3 near = search.half_sides + extent;
    const ivec3 first = cell_at(search.middle - near, search.level), last = cell_at(search.middle + near, search.level);
    const vec3 cells = vec3(last) - vec3(first) + 1;
    if (cells.x * cells.y * cells.z <= float(primitives)) search_cells(search, first, last);
    else for (uint k = 0; k < primitives; ++k) go_through(search, k);
  }
}

bool overlap(Sweep a, Sweep b) { return all(lessThanEqual(a.low, b.high)) && all(lessThanEqual(b.low, a.high)); }

float inverse_mass(uint i) { return FETCH(positions, i).w; }

// What is left of the distance between two sides at the detection, at worst, before the next one (m).
float spare_distance(float distance, float squared_relative, Sweep a, Sweep b) {
  const float relative = sqrt(squared_relative);
  const float stopped = max(max(a.step, b.step) - relative * per_substep, 0);
  return distance - relative - stopped - a.clearance - b.clearance;
}

// A cloth at rest must not push itself apart, however thick it is.
bool same_cloth(uint a, uint b) { return floatBitsToUint(FETCH(velocities, a).w) == floatBitsToUint(FETCH(velocities, b).w); }
const float share_of_rest = 0.9;

// Without a place a pair cannot be kept apart by itself: its particles are held where they are.
void add_candidate(uvec4 particle, float keep, bool edges) {
  const uint index = atomicAdd(detection[0].candidates, 1u);
  if (index < push.capacity) {
    candidates[index] = pack_candidate(particle.x, particle.y, particle.z, particle.w, keep, edges);
  } else {
    for (uint k = 0; k < 4; ++k) atomicMin(leashes[particle[k]], 0u);
  }
}
