// The sky, where nothing else is.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "sky.glsl"
#include "tone.glsl"

layout(location = 0) in vec2 in_at;
layout(location = 0) out vec4 out_colour;

void main() {
  vec3 ray = normalize(frame.ray_z.xyz + in_at.x * frame.ray_x.xyz + in_at.y * frame.ray_y.xyz);
  out_colour = picture(sky_seen(ray), gl_FragCoord.xy);
}
