// Where node k is: the centre of mass of what it carries, by shares, and its middle, the mean of the nearest of that. Both are weighted means of
// points of the finer level, CENTRE_OF and MIDDLE_OF. Differences are summed, which round as lengths do and not as places.
//
// Forces between centres, handed on by those same shares, turn nothing: what a node gives its points has no moment about their centre.
// Lengths are measured between middles (engine/effects/level/centres.cpp). Where what it carries is held (support.glsl), it is held by the
// mean of what put that out.
//
// A thread waits for memory once for kAtOnce of them. Measured on a GPU (H200): eight at once more than halve the time of the one workgroup of
// level_low, which has nothing else to do meanwhile, and more than double that of level_centre, whose workgroups have each other.

GATHER_UINT4(level_nodes)
GATHER_UINT2(level_gathers)

struct LevelPlace {
  vec3 centre, middle, put_out;   // m
};

LevelPlace place_of_point(uint i) { return LevelPlace(CENTRE_OF(i).xyz, MIDDLE_OF(i).xyz, nodes_are_held ? PUT_OUT_OF(i).xyz : vec3(0)); }

LevelPlace place_of(uint k) {
  const uint begin = unpack_level_node(FETCH(level_nodes, k)).first_gather, end = unpack_level_node(FETCH(level_nodes, k + 1)).first_gather;
  const uint first = FETCH_UINT2(level_gathers, begin).x;
  const LevelPlace from = place_of_point(first);
  LevelPlace sum = LevelPlace(vec3(0), vec3(0), vec3(0));
  for (uint g = begin + 1; g < end; g += kAtOnce) {
    LevelGather gather[kAtOnce];
    LevelPlace at[kAtOnce];
    for (uint j = 0; j < kAtOnce; ++j) gather[j] = unpack_level_gather(FETCH_UINT2(level_gathers, min(g + j, end - 1)));
    for (uint j = 0; j < kAtOnce; ++j) at[j] = place_of_point(gather[j].point);
    for (uint j = 0; j < kAtOnce; ++j) {
      if (g + j >= end) break;
      sum.centre += gather[j].in_centre * (at[j].centre - from.centre);
      sum.put_out += gather[j].in_centre * (at[j].put_out - from.put_out);
      sum.middle += gather[j].in_middle * (at[j].middle - from.middle);
    }
  }
  return LevelPlace(from.centre + sum.centre, from.middle + sum.middle, from.put_out + sum.put_out);
}
