// Closest points of four points each, first as a vertex and a triangle, then as two edges; then the same of pairs of both kinds.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/contact/proximity.glsl"

layout(local_size_x_id = 0) in;
layout(set = 0, binding = 0) readonly buffer Points { vec4 points[]; };
layout(set = 0, binding = 1) writeonly buffer Weights { vec4 weights[]; };
layout(push_constant) uniform Push { uint count; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  const vec3 a = points[4 * i].xyz, b = points[4 * i + 1].xyz, c = points[4 * i + 2].xyz, d = points[4 * i + 3].xyz;
  weights[4 * i] = closest_to_triangle(a, b, c, d);
  weights[4 * i + 1] = closest_of_edges(a, b, c, d);
  for (uint edges = 0; edges < 2; ++edges) weights[4 * i + 2 + edges] = closest_of_pair(mat4x3(a, b, c, d), edges == 1);
}
