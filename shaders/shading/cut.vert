// Cloth vertices of cut.frag.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "sky.glsl"

layout(push_constant) uniform Push { Cloth cloth; };

layout(location = 0) in vec3 in_position;
layout(location = 2) in vec2 in_uv;

layout(location = 0) out vec2 out_uv;

invariant gl_Position;

void main() {
  mat4 clip_of = cloth.view == WEFT_VIEW_SUN ? frame.sun : frame.camera;
  gl_Position = clip_of * vec4(in_position, 1.0);
  out_uv = in_uv * cloth.repeat;
}
