// Cloth with holes in its texture, where only depth is drawn.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "sky.glsl"

layout(push_constant) uniform Push { Cloth cloth; };
layout(set = 1, binding = 0) uniform sampler2D albedo_map;

layout(location = 0) in vec2 in_uv;

void main() {
  if (texture(albedo_map, in_uv).a < cloth.cutoff) discard;
}
