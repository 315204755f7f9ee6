// How far a particle goes with the nodes of the finest level, by its shares in them; one that a hand makes heavier goes less far, as far as
// the same impulse takes it. Needs predicted and positions.

GATHER_UINT4(level_shares)
GATHER(level_steps)

float lightness(uint i) {
  const float inverse_mass = FETCH(positions, i).w;
  return grab_count > 0 && inverse_mass > 0 ? min(1, FETCH(predicted, i).w / inverse_mass) : 1;
}

vec3 spread(uint i) {
  const uvec4 packed = FETCH(level_shares, i);
  if (packed.x == WEFT_NONE) return vec3(0);
  const LevelShare share = unpack_level_share(packed);
  return lightness(i) * (share.part0 * FETCH(level_steps, share.node0).xyz + share.part1 * FETCH(level_steps, share.node1).xyz +
         share.part2 * FETCH(level_steps, share.node2).xyz);
}
