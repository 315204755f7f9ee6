// How far a particle goes with the nodes of the finest level, by its shares in them; one that a hand makes heavier goes less far, as far as
// the same impulse takes it, and one that a collider holds not into that (support.glsl). Needs predicted and positions.

GATHER_UINT4(level_shares)
GATHER(level_steps)

float lightness(uint i) {
  const float inverse_mass = FETCH(positions, i).w;
  return grab_count > 0 && inverse_mass > 0 ? min(1, FETCH(predicted, i).w / inverse_mass) : 1;
}

// put_out: of the particle (m), support: by that; held (m) grows by what of the particle's step and of its nodes' is held.
vec3 spread(uint i, vec3 put_out, vec3 support, inout float held) {
  const uvec4 packed = FETCH(level_shares, i);
  if (packed.x == WEFT_NONE) return vec3(0);
  const LevelShare share = unpack_level_share(packed);
  const vec4 step = lightness(i) * (share.part0 * FETCH(level_steps, share.node0) + share.part1 * FETCH(level_steps, share.node1) +
                                    share.part2 * FETCH(level_steps, share.node2));
  if (!has_supports) return step.xyz;
  held += held_of(support, step.xyz) + step.w * length(put_out);
  return yields(support, step.xyz);
}
