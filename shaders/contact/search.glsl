// search: broad phase. A thread has an edge or a particle, looks at the clusters that are near its own, and lists the edges or triangles
// there that it may meet, for the narrow phase.
//
// SIMD divergence: threads of a group run in step, and all of them wait while one of them tests what it has found. So the search makes only
// a cheap test, and the pairs that pass it are tested exactly, one a thread, in passes of their own (pair.glsl). Threads lie beside each
// other whose clusters are the same, so that they go the same ways.
//
// Bound, as in pair.glsl. Two outlines whose middles are m apart at the detection and whose trajectories differ by r are, s substeps of H
// later, m + (s/H) r apart, which is within r/2 of m + r/2; and if one of them is stopped, another step of its trajectory.

#include "contact/track.glsl"
#include "contact/outline.glsl"

GATHER_UINT4(clusters)
GATHER(cluster_boxes)
GATHER_UINT(near_clusters)
GATHER_UINT(smooth_clusters)
GATHER(outlines)
READ_WRITE(uint, displacement_bounds)
READ_WRITE(Counters, counters)

Outline outline_at(uint primitive) {
  const vec4 middle = FETCH(outlines, 3 * primitive);
  return Outline(middle.xyz, FETCH(outlines, 3 * primitive + 1).xyz, FETCH(outlines, 3 * primitive + 2).xyz, middle.w);
}

// The thread's own.
Outline own;

// Whether it may meet `other`, from whose middle m leads to it, half a lifetime after the detection. `relative`: half the difference of
// their trajectories; `step`: the longer step of the two along each axis (m).
bool may_meet(Outline other, vec3 m, vec3 relative, float reach);

// The primitives of a cluster to test, first and one past the last.
uvec2 members_of(uint cluster);
// Whether the member can be a pair with the thread's own; the four particles; where it is put.
bool can_be_pair(uint member, out uvec4 particles);
void put_near(uint place, uint member);
uint outline_number(uint member);

// A pair beyond the capacity overflows: its particles are held in place, by a displacement bound of 0.
void add_near(uint kind, uint member, uvec4 particle) {
  const uint place = atomicAdd(detection[0].near[kind], 1u);
  // There is room for WEFT_NEAR times as many pairs of either kind as for candidates.
  if (place % WEFT_NEAR == 0 && counters[0].contacts_room <= place / WEFT_NEAR)
    atomicMax(counters[0].contacts_room, place / WEFT_NEAR + 1);
  const bool overflows = place >= WEFT_NEAR * contact_settings.capacity;
  if (!overflows) {
    put_near(place, member);
    // The first pair of a workgroup's share adds the workgroup to the narrow phase's dispatch.
    const uint groups = place / gl_WorkGroupSize.x + 1;
    if (place % gl_WorkGroupSize.x == 0 && kind == of_triangles) atomicMax(detection[0].near_faces.x, groups);
    if (place % gl_WorkGroupSize.x == 0 && kind == of_edges) atomicMax(detection[0].near_edges.x, groups);
    return;
  }
  atomicAdd(counters[0].contacts_overflowed, 1u);
  for (uint k = 0; k < 4; ++k)
    atomicMin(displacement_bounds[k < 2 ? (k == 0 ? particle.x : particle.y) : k == 2 ? particle.z : particle.w], 0u);
}

void visit(uint kind, uint member) {
  const Outline other = outline_at(outline_number(member));
  const vec3 half_relative = 0.5 * (own.trajectory - other.trajectory);
  const float reach = (1 + 4 * rounding) * (own.reach + other.reach);
  if (!may_meet(other, own.middle - other.middle + half_relative, half_relative, reach)) return;
  uvec4 particles;
  if (can_be_pair(member, particles)) add_near(kind, member, particles);
}

// `cluster`: the thread's own; `all`: also clusters before it, as only one of two edges is to find the other.
void search(uint kind, uint cluster, bool all) {
  const vec3 size = abs(own.half_sides) + own.reach, end = own.middle + own.trajectory;
  const vec3 low = min(own.middle, end) - size, high = max(own.middle, end) + size;
  const uint row = (WEFT_NEAR_CLUSTERS + 1) * cluster, listed = FETCH_UINT(near_clusters, row);
  const bool every_one = listed > WEFT_NEAR_CLUSTERS, is_smooth = FETCH_UINT(smooth_clusters, cluster) != 0;
  for (uint k = 0; k < (every_one ? contact_settings.clusters : listed); ++k) {
    const uint entry = every_one ? k : FETCH_UINT(near_clusters, row + 1 + k), other = entry & ~WEFT_TOUCHING;
    if (!all && other < cluster) continue;
    if (other != entry && (is_smooth || FETCH_UINT(smooth_clusters, other) != 0)) continue;   // they cannot meet (smooth.glsl)
    const vec3 its_low = FETCH(cluster_boxes, 2 * other).xyz, its_high = FETCH(cluster_boxes, 2 * other + 1).xyz;
    if (any(greaterThan(its_low, high)) || any(lessThan(its_high, low))) continue;
    const uvec2 members = members_of(other);
    for (uint member = members.x; member < members.y; ++member) visit(kind, member);
  }
}
