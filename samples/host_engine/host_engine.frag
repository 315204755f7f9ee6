// Lambert under one sun, a sky that is brighter from above, and haze that hides where the floor ends.
#version 450

layout(push_constant) uniform Push {
  mat4 to_clip;
  vec4 place;   // xyz: m
  vec4 scale;   // xyz
  vec4 colour;  // rgb: linear; a: 1 lit, 0 as it is
  vec4 sun;     // xyz: unit, the way the light goes
} push;

layout(location = 0) in vec3 world_normal;
layout(location = 0) out vec4 shaded;

const vec3 kHaze = vec3(0.55, 0.63, 0.72);   // also the background: samples/host_engine/renderer.cpp clears to it

void main() {
  vec3 normal = normalize(gl_FrontFacing ? world_normal : -world_normal);   // cloth is seen from both sides
  vec3 sun = 0.85 * max(dot(normal, -push.sun.xyz), 0) * vec3(1, 0.95, 0.86);
  vec3 sky = mix(vec3(0.11, 0.10, 0.09), vec3(0.30, 0.34, 0.40), 0.5 + 0.5 * normal.y);
  vec3 lit = push.colour.rgb * mix(vec3(1), sun + sky, push.colour.a);
  float distance = 1 / gl_FragCoord.w;   // m, along the view
  shaded = vec4(mix(lit, kHaze, smoothstep(5, 16, distance)), 1);
}
