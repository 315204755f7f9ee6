// surface.vert: a triangle's corner, fetched by number, so that what belongs to a triangle needs no vertices of its own; or a vertex, where
// nothing of a triangle's is shown: there are a sixth as many.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "samples/view/view.glsl"

layout(push_constant) uniform Push { Surface surface; };

layout(location = 0) out vec3 out_normal;
layout(location = 1) out vec2 out_uv;
layout(location = 2) out vec3 out_corner;        // barycentric: 0 on the side across from each corner
layout(location = 3) out flat float out_strain;  // of the side that is strained most

float strain_of(vec3 rest, vec3 a, vec3 b, vec3 c) {
  if (rest.x == 0.0) return 0.0;
  const vec3 strains = vec3(distance(a, b), distance(b, c), distance(c, a)) / rest - 1.0;
  const vec3 sizes = abs(strains);
  if (sizes.x >= sizes.y && sizes.x >= sizes.z) return strains.x;
  return sizes.y >= sizes.z ? strains.y : strains.z;
}

void main() {
  uint own = gl_VertexIndex;
  out_corner = vec3(1);
  out_strain = 0.0;
  if (surface.by_index == 0) {
    const uint triangle = surface.first_triangle + gl_VertexIndex / 3, k = gl_VertexIndex % 3;
    const uint a = corners[3 * triangle], b = corners[3 * triangle + 1], c = corners[3 * triangle + 2];
    own = k == 0 ? a : k == 1 ? b : c;
    out_corner = vec3(k == 0, k == 1, k == 2);
    if (surface.colouring == VIEW_STRAIN) out_strain = strain_of(rests[triangle].xyz, positions[a].xyz, positions[b].xyz, positions[c].xyz);
  }
  out_normal = normals[own].xyz;
  out_uv = uvs[own] * surface.repeat;
  gl_Position = frame.camera * vec4(positions[own].xyz, 1.0);
}
