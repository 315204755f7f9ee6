// A particle's row of the matrix, times a vector p, without its mass: the sum over its springs of B (p_i - p_j), B = u u^T + a I. p_j is
// read from `exchanged`, from `first` on, or as OFFERED says.

#include "implicit/implicit_filter.glsl"

GATHER(collider_filters)

vec3 filtered(uint i, vec3 v) { return has_colliders ? apply_filter(FETCH(collider_filters, 2 * i), v) : v; }

#ifndef OFFERED
#define OFFERED(i) FETCH(exchanged, i).xyz
#endif

vec3 pull(vec3 p, uint other, vec4 block) {
  const vec3 d = p - OFFERED(other);
  return block.w * d + dot(block.xyz, d) * block.xyz;
}

vec3 pulls(uint i, vec3 p, uint first) {
  const uvec2 row = FETCH_UINT2(spring_rows, i);
  vec3 sum = vec3(0);
  for (uint q = row.x; q < row.x + row.y; ++q) {
    const uvec4 ends = FETCH(spring_ends, q) + first;
    sum += pull(p, ends.x, FETCH(spring_blocks, 4 * q));
    sum += pull(p, ends.y, FETCH(spring_blocks, 4 * q + 1));
    sum += pull(p, ends.z, FETCH(spring_blocks, 4 * q + 2));
    sum += pull(p, ends.w, FETCH(spring_blocks, 4 * q + 3));
  }
  return sum;
}
