// Coarse levels as a preconditioner of conjugate gradients: what is long in the residual is solved for at once, over the nodes of
// engine/effects/level, instead of running an edge an iteration. It is additive (Bramble, Pasciak and Xu 1990): each level l adds
//     c P (M + G)^-1 P^T r,        z = D^-1 r + sum over levels,
// P the shares by which particles go with the level's nodes, M what a node carries, and G the diagonal block of P^T (h^2 K + h D) P. That
// is symmetric and positive definite whatever blocks are, so conjugate gradients converge to the same solution, only sooner.
//
// Nothing is summed over springs. By the nodes' gathers, weights that sum to one, M^-1 P^T r is the mean of M^-1 r, from level to level; and
// G is taken to be g M S, S the mean of the blocks of what it carries and g a number of the springs at rest
// (engine/effects/implicit/levels.cpp). So a level adds c P (1 + g S)^-1 of a mean.
//
// What colliders constrain does not go with its node. The springs between it and what does are strained by all of the change, and not by
// the little by which shares differ, so 1 + g S has H besides, the mean of (1 - F) tr(B) / m: F a particle's filter, B its springs' block and
// m its mass. (Without it a sheet that lies in part took more iterations on levels than off them.)
//
// Needs RESIDUAL_OF(i) and BLOCK_OF(i, part), of what is gathered: its residual over its mass (m/s), and its part kSprings of S (kg) or
// kHeld of H.

GATHER_UINT4(level_nodes)
GATHER_UINT2(level_gathers)

uint gathers_from(uint k) { return unpack_level_node(FETCH(level_nodes, k)).first_gather; }

// The first gather has what the others leave.
vec3 mean_residual(uint k) {
  const uint begin = gathers_from(k), end = gathers_from(k + 1);
  const vec3 from = RESIDUAL_OF(FETCH_UINT2(level_gathers, begin).x);
  vec3 sum = vec3(0);
  for (uint g = begin + 1; g < end; ++g) {
    const LevelGather gather = unpack_level_gather(FETCH_UINT2(level_gathers, g));
    sum += gather.in_centre * (RESIDUAL_OF(gather.point) - from);
  }
  return from + sum;
}

Block mean_block(uint k, uint part) {
  const uint begin = gathers_from(k), end = gathers_from(k + 1);
  const Block from = BLOCK_OF(FETCH_UINT2(level_gathers, begin).x, part);
  Block sum = from;
  for (uint g = begin + 1; g < end; ++g) {
    const LevelGather gather = unpack_level_gather(FETCH_UINT2(level_gathers, g));
    const Block at = BLOCK_OF(gather.point, part);
    sum.diagonal += gather.in_centre * (at.diagonal - from.diagonal);
    sum.below += gather.in_centre * (at.below - from.below);
  }
  return sum;
}
