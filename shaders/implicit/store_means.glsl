// What implicit_mean and implicit_mean_wide store for a node. Needs implicit/mean.glsl, level_residuals, level_blocks and linear.

void main() {
  if (gl_GlobalInvocationID.x >= push.count || linear[0].done != 0) return;
  const uint k = push.first + gl_GlobalInvocationID.x;
  level_residuals[k] = vec4(mean_residual(k), 0);
  for (uint part = 0; part < kParts && push.iteration == 0; ++part) {
    const Block block = mean_block(k, part);
    level_blocks[4 * k + 2 * part] = vec4(block.diagonal, 0);
    level_blocks[4 * k + 2 * part + 1] = vec4(block.below, 0);
  }
}
