// How far a particle goes with the nodes of the finest level, by its shares in them.

GATHER_UINT4(level_shares)
GATHER(level_steps)

vec3 spread(uint i) {
  const uvec4 packed = FETCH(level_shares, i);
  if (packed.x == WEFT_NONE) return vec3(0);
  const LevelShare share = unpack_level_share(packed);
  return share.part0 * FETCH(level_steps, share.node0).xyz + share.part1 * FETCH(level_steps, share.node1).xyz +
         share.part2 * FETCH(level_steps, share.node2).xyz;
}
