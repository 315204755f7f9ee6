// backdrop.frag: what lies behind everything.
#version 460
layout(location = 0) out vec4 out_colour;
layout(push_constant) uniform Push { vec2 pixel; };

void main() { out_colour = vec4(mix(vec3(0.42, 0.45, 0.5), vec3(0.24, 0.25, 0.28), 0.5 * gl_FragCoord.y * pixel.y), 1); }
