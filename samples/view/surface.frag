// surface.frag: cloth, lit plainly or in the colours of what it is asked about, with its triangles' edges.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "samples/view/view.glsl"

layout(push_constant) uniform Push { Surface surface; };
layout(set = 1, binding = 0) uniform sampler2D albedo_map;
layout(set = 1, binding = 1) uniform sampler2D normal_map;
layout(set = 1, binding = 2) uniform sampler2D roughness_map;
layout(set = 1, binding = 3) uniform sampler2D occlusion_map;

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec2 in_uv;
layout(location = 2) in vec3 in_corner;
layout(location = 3) in flat float in_strain;
layout(location = 0) out vec4 out_colour;

vec3 colour_of(vec3 n) {
  if (surface.colouring == VIEW_STRAIN) return strain_colour(in_strain / surface.strain) * (0.75 + 0.25 * max(dot(n, frame.to_sun), 0.0));
  if (surface.colouring == VIEW_NORMALS) return 0.5 + 0.5 * n;
  if (surface.colouring == VIEW_NORMAL_MAP) return texture(normal_map, in_uv).rgb;
  if (surface.colouring == VIEW_ROUGHNESS) return texture(roughness_map, in_uv).rrr;
  if (surface.colouring == VIEW_OCCLUSION) return texture(occlusion_map, in_uv).rrr;
  const vec3 albedo = texture(albedo_map, in_uv).rgb;
  return srgb(surface.colouring == VIEW_ALBEDO ? albedo : lit(surface.colour * albedo, n));
}

void main() {
  vec3 n = dot(in_normal, in_normal) > 1e-12 ? normalize(in_normal) : vec3(0, 1, 0);
  if (!gl_FrontFacing) n = -n;
  vec3 colour = colour_of(n);
  if (surface.wires != 0) {
    const vec3 pixels = in_corner / max(fwidth(in_corner), vec3(1e-6));
    colour = mix(0.25 * colour, colour, smoothstep(0.4, 1.2, min(pixels.x, min(pixels.y, pixels.z))));
  }
  out_colour = vec4(colour, 1);
}
