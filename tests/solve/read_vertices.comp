// A host's reader of vertices: copies each of them twice, once from where it is bound and once from its address.
#version 450
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

layout(local_size_x = 64) in;
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Vertices { vec4 at[]; };
layout(std430, set = 0, binding = 0) readonly buffer BOUND { vec4 bound[]; };
layout(std430, set = 0, binding = 1) writeonly buffer COPIES { vec4 copies[]; };
layout(push_constant) uniform Push {
  uvec2 address;
  uint count;
  uint unused;
} push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  copies[2 * i] = bound[i];
  copies[2 * i + 1] = Vertices(push.address).at[i];
}
