// lines.vert: lines and squares of a width in pixels, two triangles each, of places or of vertices where the simulation has them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "samples/view/view.glsl"

layout(push_constant) uniform Push { Lines lines; };

layout(location = 0) out vec3 out_colour;

const vec2 kCorners[6] = {vec2(0, -1), vec2(1, -1), vec2(1, 1), vec2(0, -1), vec2(1, 1), vec2(0, 1)};

void main() {
  const uint number = gl_VertexIndex / 6;
  const vec2 corner = kCorners[gl_VertexIndex % 6];
  out_colour = lines.colour;
  if (lines.kind == VIEW_MARKS) {
    gl_Position = frame.camera * vec4(positions[marked[number]].xyz, 1.0);
    gl_Position.xy += vec2(2.0 * corner.x - 1.0, corner.y) * lines.width * lines.pixel * gl_Position.w;
    return;
  }
  vec3 from, to;
  if (lines.kind == VIEW_SPIKES) {
    from = positions[number].xyz;
    to = from + lines.reach * normals[number].xyz;
  } else {
    from = segments[2 * number].xyz;
    to = segments[2 * number + 1].xyz;
  }
  const vec4 a = frame.camera * vec4(from, 1.0), b = frame.camera * vec4(to, 1.0);
  if (a.w <= frame.near_plane || b.w <= frame.near_plane) {   // an end behind the camera: not drawn
    gl_Position = vec4(0, 0, 0, 1);
    return;
  }
  vec2 along = (b.xy / b.w - a.xy / a.w) / lines.pixel;
  along = dot(along, along) > 1e-12 ? normalize(along) : vec2(1, 0);
  gl_Position = corner.x == 0.0 ? a : b;
  gl_Position.xy += 0.5 * lines.width * corner.y * vec2(-along.y, along.x) * lines.pixel * gl_Position.w;
}
