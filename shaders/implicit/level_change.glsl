// What levels add to the change of a node's velocity (m/s; mean.glsl). Needs CHANGE(k), of the next coarser level, RESIDUAL_OF(k) and
// BLOCK_OF(k).

READ(float, level_grips)
GATHER_UINT4(level_node_shares)

vec3 carried(uvec4 packed) {
  if (packed.x == WEFT_NONE) return vec3(0);
  const LevelShare share = unpack_level_share(packed);
  return share.part0 * CHANGE(share.node0) + share.part1 * CHANGE(share.node1) + share.part2 * CHANGE(share.node2);
}

vec3 change_of_node(uint k) {
  const float grip = level_grips[k];
  vec3 own = vec3(0);
  if (grip >= 0) {
    Block block = BLOCK_OF(k, kSprings);
    block = Block(1 + grip * block.diagonal, grip * block.below);
    if (has_colliders) {
      const Block held = BLOCK_OF(k, kHeld);
      block = Block(block.diagonal + held.diagonal, block.below + held.below);
    }
    own = WEFT_LEVEL_PART * preconditioned(factor_of(block.diagonal, block.below, 1), RESIDUAL_OF(k));
  }
  return own + carried(FETCH(level_node_shares, k));
}
