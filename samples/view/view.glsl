// What the viewer's shaders share: the frame, and the buffers of the simulation, read where they are.
#include "shading/frame.h"
#include "samples/view/view.h"

layout(set = 0, binding = 0) uniform FrameBlock { Frame frame; };
layout(set = 0, binding = 1, std430) readonly buffer Positions { vec4 positions[]; };
layout(set = 0, binding = 2, std430) readonly buffer Normals { vec4 normals[]; };
layout(set = 0, binding = 3, std430) readonly buffer Corners { uint corners[]; };     // vertices, three a triangle
layout(set = 0, binding = 4, std430) readonly buffer Rests { vec4 rests[]; };         // sides' lengths at rest (m); 0: not known
layout(set = 0, binding = 5, std430) readonly buffer Uvs { vec2 uvs[]; };
layout(set = 0, binding = 6, std430) readonly buffer Marked { uint marked[]; };       // vertices
layout(set = 0, binding = 7, std430) readonly buffer Segments { vec4 segments[]; };   // ends, two a line (m)

// Light from the sun, and from a sky that is brighter above.
vec3 lit(vec3 colour, vec3 n) {
  const float sun = max(dot(n, frame.to_sun), 0.0), sky = 0.5 + 0.5 * n.y;
  return colour * (0.18 + 0.32 * sky + 0.6 * sun);
}

vec3 srgb(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(max(linear, vec3(0)), vec3(1 / 2.4)) - 0.055, step(vec3(0.0031308), linear));
}
