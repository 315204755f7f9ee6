// render_mesh: what a coarse cloth carries, once a frame: the position and the normal of every vertex of a finer mesh that is drawn in its
// place. A vertex is bound to a triangle, by weights and an offset. The triangle is taken to be curved as its corners' normals say (Phong
// tessellation: Boubekeur and Alexa 2008; half of the way to the tangent planes instead of their 3/4, with which round cloth bulges), so
// that the cells of the cloth do not show; the offset is in the axes of the place that the weights choose, so that what stands off the
// cloth turns with it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ(Carried, carried)
READ_WRITE(vec4, vertex_positions)
READ_WRITE(vec4, vertex_normals)

vec3 unit(vec3 v, vec3 otherwise) {
  const float size = length(v);
  return size > 1e-20 ? v / size : otherwise;
}

void main() {
  const uint k = gl_GlobalInvocationID.x;
  if (k >= push.count) return;
  const Carried bound = carried[k];
  const vec3 w = vec3(bound.weights[0], bound.weights[1], 1 - bound.weights[0] - bound.weights[1]);
  mat3 x, n;
  for (int c = 0; c < 3; ++c) {
    x[c] = vertex_positions[bound.corners[c]].xyz - vertex_positions[bound.corners[0]].xyz;
    n[c] = vertex_normals[bound.corners[c]].xyz;
  }
  const vec3 flat_place = x * w;
  vec3 curve = vec3(0);
  for (int c = 0; c < 3; ++c) curve -= w[c] * dot(flat_place - x[c], n[c]) * n[c];
  const vec3 place = flat_place + WEFT_PHONG_CURVE * curve;
  const vec3 up = unit(n * w, n[0]);
  const vec3 aside = abs(up.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0);
  const vec3 along = unit(x[1] - dot(x[1], up) * up, normalize(cross(aside, up)));
  const mat3 axes = mat3(along, cross(up, along), up);
  const uint v = bound.vertex;
  vertex_positions[v] = vec4(vertex_positions[bound.corners[0]].xyz + place + axes * unpack(bound.offset), 1);
  vertex_normals[v] = vec4(axes * unpack(bound.normal), 0);
}
