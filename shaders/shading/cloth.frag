// Cloth: four maps, both sides.
//
// The tangent frame comes from how position and UV change over the screen (Schueler, "Normal mapping without precomputed
// tangents", ShaderX5 2007), so the simulation need not carry tangents through large rotations.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "sky.glsl"
#include "light.glsl"
#include "tone.glsl"

layout(push_constant) uniform Push { Cloth cloth; };
layout(set = 1, binding = 0) uniform sampler2D albedo_map;
layout(set = 1, binding = 1) uniform sampler2D normal_map;
layout(set = 1, binding = 2) uniform sampler2D roughness_map;
layout(set = 1, binding = 3) uniform sampler2D occlusion_texture;

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 0) out vec4 out_colour;

// The map's normal (green up, as in glTF, where v goes down) in the world. The gradients of u and v over the surface solve
// dot(gradient, dp) = d(uv) for both screen directions; the sign of the determinant makes them true on either side.
vec3 mapped_normal(vec3 n, vec3 map) {
  vec3 dx = dFdx(in_position), dy = dFdy(in_position);
  vec2 uv_x = dFdx(in_uv), uv_y = dFdy(in_uv);
  vec3 across_y = cross(dy, n), across_x = cross(n, dx);
  vec3 u = across_y * uv_x.x + across_x * uv_y.x;
  vec3 v = across_y * uv_x.y + across_x * uv_y.y;
  float longest = max(dot(u, u), dot(v, v));
  if (longest < 1e-20) return n;
  float scale = sign(dot(dx, across_y)) * inversesqrt(longest);
  return normalize(scale * (map.x * u - map.y * v) + map.z * n);
}

void main() {
  Surface s;
  s.position = in_position;
  vec3 smooth_normal = dot(in_normal, in_normal) > 1e-12 ? normalize(in_normal) : vec3(0, 1, 0);
  if (!gl_FrontFacing) smooth_normal = -smooth_normal;
  s.smooth_normal = smooth_normal;
  vec3 map = 2.0 * texture(normal_map, in_uv).xyz - 1.0;
  s.normal = mapped_normal(smooth_normal, map);
  vec4 albedo = texture(albedo_map, in_uv);
  s.albedo = cloth.colour * albedo.rgb;
  // Far away, one texel of a small mip level stands for many directions; their mean is short, and what was relief becomes
  // roughness (Toksvig 2005).
  float spread = clamp((1.0 - length(map)) * 2.0, 0.0, 0.5);
  vec2 rough_metal = texture(roughness_map, in_uv).rg;
  float roughness = clamp(cloth.roughness * rough_metal.r, 0.05, 1.0);
  s.roughness = clamp(sqrt(sqrt(roughness * roughness * roughness * roughness + spread * spread)), 0.05, 1.0);
  s.metallic = cloth.metallic * rough_metal.g;
  s.occlusion = texture(occlusion_texture, in_uv).r * screen_occlusion();
  s.fuzz = 0.15 * smoothstep(0.45, 0.8, roughness) * (1.0 - s.metallic);
  s.transmission = cloth.transmission;
  if (albedo.a < cloth.cutoff) discard;   // last: its neighbours took their gradients from it
  out_colour = picture(reflected(s), gl_FragCoord.xy);
}
