// The sky, where nothing else is.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "sky.glsl"
#include "tone.glsl"

layout(location = 0) out vec4 out_colour;

void main() {
  vec2 at = 2.0 * gl_FragCoord.xy * frame.size.zw - 1.0;
  vec3 ray = normalize(frame.ray_z.xyz + at.x * frame.ray_x.xyz + at.y * frame.ray_y.xyz);
  out_colour = picture(sky_seen(ray), gl_FragCoord.xy);
}
