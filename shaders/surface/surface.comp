// surface: what the renderer draws, once a frame: the position of every render vertex and its normal, the sum of the normals
// of the triangles around its particle, each weighted by its area. Vertices on both sides of a UV seam belong to one
// particle and therefore get one normal.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER_UINT4(surface_rows)
GATHER_UINT2(corners)
WRITE(vec4, vertex_positions)
WRITE(vec4, vertex_normals)

vec3 normal_at(vec3 x, uint first, uint end) {
  vec3 sum = vec3(0);
  for (uint k = first; k < end; ++k) {
    const uvec2 others = FETCH_UINT2(corners, k);
    sum += cross(FETCH(positions, others.x).xyz - x, FETCH(positions, others.y).xyz - x);
  }
  const float len = length(sum);
  return len > 1e-20 ? sum / len : vec3(0, 1, 0);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const uvec4 row = FETCH(surface_rows, i);
  const vec3 x = FETCH(positions, row.x).xyz;
  vertex_positions[i] = vec4(x + motion.origin, 1);
  vertex_normals[i] = vec4(normal_at(x, row.y, row.y + row.z), 0);
}
