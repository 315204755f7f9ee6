// search: broad phase. A thread has an edge or a particle, looks at the clusters that are near its own, and lists the edges or triangles
// there that it may meet, for the narrow phase.
//
// SIMD divergence: threads of a group run in step, and all of them wait while one of them does what the others need not. So the search
// makes only a cheap test, and the pairs that pass it are tested exactly, one a thread, in passes of their own (pair.glsl). Threads lie
// beside each other whose clusters are the same, so that they go the same ways. And what is rarer has a loop of its own: a thread
// first finds the clusters that it has to look into, a bit each, then in each of them the members, and then lists these, so that threads
// wait for each other's longest lists, not for each other's every find. (With one loop for all, the search took two to three times as long
// on the software driver, which runs through every branch.)
//
// Bound, as in pair.glsl. Two outlines whose middles are m apart at the detection and whose trajectories differ by r are, s substeps of H
// later, m + (s/H) r apart, which is within r/2 of m + r/2; and if one of them is stopped, another step of its trajectory.
//
// Needs contact/track.glsl, Detection, Counters and displacement_bounds.

#include "contact/outline.glsl"
#include "contact/cluster.glsl"
#include "contact/outline_box.glsl"
#include "contact/near_list.glsl"

GATHER_UINT4(clusters)
GATHER(cluster_boxes)
GATHER_UINT(near_clusters)
GATHER_UINT4(near_boxes)
GATHER(outlines)
GATHER_UINT4(outline_boxes)

Outline outline_at(uint primitive) {
  const vec4 middle = FETCH(outlines, 3 * primitive);
  return Outline(middle.xyz, FETCH(outlines, 3 * primitive + 1).xyz, FETCH(outlines, 3 * primitive + 2).xyz, middle.w);
}

Box box_at(uint cluster) { return Box(FETCH(cluster_boxes, 2 * cluster).xyz, FETCH(cluster_boxes, 2 * cluster + 1).xyz); }

// The thread's own.
Outline own;
// per_substep(). Looked up for each pair it was a tenth of the search: the software driver reads buffers that are written lane by lane.
float part_of_lifetime;

// Whether it may meet `other`, from whose middle m leads to it, half a lifetime after the detection. `relative`: half the difference of
// their trajectories; `reach`: how far both may be from there (m).
bool may_meet(Outline other, vec3 m, vec3 relative, float reach);

// The primitives of a cluster to test, first and one past the last.
uvec2 members_of(uint cluster);
// Whether the member can be a pair with the thread's own; the four particles; where it is put.
bool can_be_pair(uint member, out uvec4 particles);
void put_near(uint place, uint member);
uint outline_number(uint member);
uint member_of(uint number) { return number - outline_number(0); }

bool meets(uint number) {
  const Outline other = outline_at(number);
  const vec3 half_relative = 0.5 * (own.trajectory - other.trajectory);
  const float reach = (1 + 4 * rounding) * (own.reach + other.reach);
  return may_meet(other, own.middle - other.middle + half_relative, half_relative, reach);
}

// A bit for each of the primitives from `first` on, an even number, that is among `numbers`, can be a pair with the thread's own and may
// meet it; of 32 at most. Of most a box tells that they do not, and two are fetched at once (outline_box.glsl). `box`: the thread's own.
uint pairs_among(uint first, uvec2 numbers, uvec2 box) {
  uint near = 0, pairs = 0;
  uvec4 particles;
  for (uint k = 0; k < 32 && first + k < numbers.y; k += 2) {
    const uvec4 boxes = FETCH(outline_boxes, (first + k) / 2);
    near |= (uint(overlap(boxes.xy, box)) | uint(overlap(boxes.zw, box)) << 1) << k;
  }
  if (numbers.x > first) near &= ~1u;
  if (numbers.y < first + 32) near &= (1u << (numbers.y - first)) - 1;
  for (; near != 0; near &= near - 1) {
    const uint number = first + uint(findLSB(near));
    if (meets(number) && can_be_pair(member_of(number), particles)) pairs |= near & -near;
  }
  return pairs;
}

// Of the thread's pairs: one past the last one's place, and how many have found no room.
uint last_place = 0, overflowed = 0;

// `first`: the number of the first of `pairs`.
void add_near(uint kind, uint first, uint pairs) {
  const uint count = uint(bitCount(pairs)), room = WEFT_NEAR * contact_settings.capacity;
  if (count == 0) return;
  uint place = atomicAdd(detection[0].near[kind], count);
  last_place = place + count;
  for (; pairs != 0 && place < room; pairs &= pairs - 1) put_near(place++, member_of(first + uint(findLSB(pairs))));
  overflowed += uint(bitCount(pairs));
}

// Holds in place, by a displacement bound of 0, the particles of all pairs of a thread of which one has overflowed.
void hold(uint first, uint pairs) {
  for (; pairs != 0; pairs &= pairs - 1) {
    uvec4 particle;
    can_be_pair(member_of(first + uint(findLSB(pairs))), particle);
    for (uint k = 0; k < 4; ++k) atomicMin(displacement_bounds[particle[k]], 0u);
  }
}

// Looks into a cluster, whose box is `its`.
void look_into(uint kind, uint other, Box its, Box own_box, bool holds) {
  const uvec2 members = members_of(other);
  const uvec2 numbers = uvec2(outline_number(members.x), outline_number(members.y)), box = pack_box(its, own_box);
  for (uint first = numbers.x & ~1u; first < numbers.y; first += 32) {
    const uint pairs = pairs_among(first, numbers, box);
    if (holds) hold(first, pairs);
    else add_near(kind, first, pairs);
  }
}

// A bit for each of the entries of a list from `first` on, an even number, whose boxes overlap; of 32 at most.
uint near_among(uint boxes, uint first, uint end, uvec2 box) {
  uint near = 0;
  for (uint k = 0; k < 32 && first + k < end; k += 2) {
    const uvec4 two = FETCH(near_boxes, boxes + (first + k) / 2);
    near |= (uint(overlap(two.xy, box)) | uint(overlap(two.zw, box)) << 1) << k;
  }
  if (end < first + 32) near &= (1u << (end - first)) - 1;
  return near;
}

// `cluster`: the thread's own; `all`: also clusters before it, as only one of two edges is to find the other.
void search_listed(uint kind, uint cluster, NearList near, bool all, bool holds) {
  const Box own_box = box_of(own);
  const uvec2 box = pack_box(box_at(cluster), own_box);
  const uint entries = all ? near.count : near.later;
  for (uint first = 0; first < entries; first += 32)
    for (uint found = near_among(boxes_of(cluster), first, entries, box); found != 0; found &= found - 1) {
      const uint other = FETCH_UINT(near_clusters, near.first + first + uint(findLSB(found)));
      look_into(kind, other, box_at(other), own_box, holds);
    }
}

// Where the list had no room: through all clusters.
void search_all(uint kind, uint cluster, bool all, bool holds) {
  const Box own_box = box_of(own);
  for (uint other = all ? 0 : cluster; other < contact_settings.clusters; ++other) {
    Box its;
    for (bool found = false; !found && other < contact_settings.clusters; other += uint(!found)) {
      its = box_at(other);
      found = !any(greaterThan(its.low, own_box.high)) && !any(lessThan(its.high, own_box.low));
    }
    if (other >= contact_settings.clusters) return;
    look_into(kind, other, its, own_box, holds);
  }
}

NearList list_of(uint cluster) { return near_list(cluster, FETCH_UINT(near_clusters, row_of(cluster))); }

void search(uint kind, uint cluster, bool all, bool holds) {
  const NearList near = list_of(cluster);
  if (near.every_one) search_all(kind, cluster, all, holds);
  else search_listed(kind, cluster, near, all, holds);
}

// Adds what the search has listed to the narrow phase's dispatch, and counts what overflowed: whose pairs have, must search again, to hold
// them.
void end_search(uint kind) {
  const uint room = WEFT_NEAR * contact_settings.capacity;
  const uint groups = (min(last_place, room) + gl_WorkGroupSize.x - 1) / gl_WorkGroupSize.x;
  if (kind == of_triangles && detection[0].near_faces.x < groups) atomicMax(detection[0].near_faces.x, groups);
  if (kind == of_edges && detection[0].near_edges.x < groups) atomicMax(detection[0].near_edges.x, groups);
  if (detection[0].near_pairs.x < groups) atomicMax(detection[0].near_pairs.x, groups);
  // There is room for WEFT_NEAR times as many pairs of either kind as for candidates.
  const uint wanted = (last_place + WEFT_NEAR - 1) / WEFT_NEAR;
  if (counters[0].contacts_room < wanted) atomicMax(counters[0].contacts_room, wanted);
  if (overflowed != 0) atomicAdd(counters[0].contacts_overflowed, overflowed);
}
