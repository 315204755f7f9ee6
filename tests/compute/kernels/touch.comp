// Touches one resource of every kind that reflection knows. Compiled and reflected, never run.
#version 450
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 3, local_size_y = 2) in;
layout(constant_id = 7) const float damping = 0.5;

struct Edge {
  uint a, b;
  float rest;
};
layout(scalar, set = 0, binding = 0) readonly buffer EDGES { Edge edges[]; };
layout(scalar, set = 0, binding = 2) writeonly buffer RESULT { vec3 result[]; };
layout(scalar, set = 0, binding = 1) buffer COUNTS { uint counts[]; };
layout(set = 1, binding = 4) uniform samplerBuffer POSITIONS;
layout(set = 1, binding = 5, r32f) uniform writeonly imageBuffer HEIGHTS;
layout(set = 1, binding = 6) uniform sampler2D PICTURE;
layout(set = 1, binding = 7) uniform VIEW { mat4 view; };
layout(push_constant, scalar) uniform Push {
  vec3 gravity;
  float seconds;
  uint n[3];
} push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.n[1]) return;
  vec3 position = texelFetch(POSITIONS, int(edges[i].a)).xyz;
  vec3 colour = texture(PICTURE, vec2(0)).xyz;
  result[i] = position * damping + push.gravity * push.seconds + (view * vec4(colour, 1)).xyz;
  atomicAdd(counts[0], 1);
  imageStore(HEIGHTS, int(i), vec4(1));
}
