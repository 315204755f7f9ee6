// solid.frag: a collider in its colour; planes have a grid that fades.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "samples/view/view.glsl"

layout(push_constant) uniform Push { Solid solid; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_plane;
layout(location = 0) out vec4 out_colour;

void main() {
  vec3 colour = lit(solid.colour, normalize(in_normal));
  if (solid.cell > 0.0) {
    const vec2 at = in_plane / solid.cell, width = max(fwidth(at), vec2(1e-5));
    const vec2 away = abs(fract(at - 0.5) - 0.5) / width;
    const float joint = (1.0 - smoothstep(0.5, 1.5, min(away.x, away.y))) * clamp(1.0 - 2.0 * max(width.x, width.y), 0.0, 1.0);
    colour *= 1.0 - 0.35 * joint;
    const float far = distance(in_position, frame.eye) / frame.fade;
    colour = mix(vec3(0.1, 0.11, 0.13), colour, exp(-far * far));
  }
  out_colour = vec4(srgb(colour), 1);
}
