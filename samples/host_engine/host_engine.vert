// The host engine's only vertex shader: places a mesh, or a cloth that Weft has placed already.
#version 450

layout(push_constant) uniform Push {
  mat4 to_clip;
  vec4 place;   // xyz: m
  vec4 scale;   // xyz
  vec4 colour;  // rgb: linear; a: 1 lit, 0 as it is
  vec4 sun;     // xyz: unit, the way the light goes
} push;

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 world_normal;

void main() {
  world_normal = normal / push.scale.xyz;
  gl_Position = push.to_clip * vec4(position * push.scale.xyz + push.place.xyz, 1);
}
