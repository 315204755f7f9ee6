// The centre of mass of what node k carries, by shares: the weighted mean of points of the finer level, POINT. Their differences are summed,
// which round as lengths do and not as places.
//
// Forces between centres, handed on by those same shares, turn nothing: what a node gives its points has no moment about their centre. And a
// centre does not follow each point to and fro.

GATHER_UINT4(level_nodes)
GATHER_UINT2(level_gathers)

vec3 centre_of(uint k) {
  const uint begin = unpack_level_node(FETCH(level_nodes, k)).first_gather, end = unpack_level_node(FETCH(level_nodes, k + 1)).first_gather;
  const vec3 first = POINT(FETCH_UINT2(level_gathers, begin).x).xyz;
  vec3 sum = vec3(0);
  for (uint g = begin + 1; g < end; ++g) {
    const uvec2 gather = FETCH_UINT2(level_gathers, g);
    sum += uintBitsToFloat(gather.y) * (POINT(gather.x).xyz - first);
  }
  return first + sum;
}
