// detect_pair: pair_faces and pair_edges in one dispatch, on a GPU: the first row of workgroups does
// one, the second the other.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT4(cluster_faces)
GATHER_UINT4(cluster_edges)
READ(uvec2, near_faces)
READ(uvec2, near_edges)

#include "contact/narrow.glsl"
#include "contact/pair_faces.glsl"
#include "contact/pair_edges.glsl"

// push.count: places in near_faces, and in near_edges.
void main() {
  const uint i = gl_GlobalInvocationID.x, kind = gl_WorkGroupID.y == 0 ? of_triangles : of_edges;
  if (i >= min(push.count, detection[0].near[kind])) return;
  if (kind == of_triangles) pair_face(near_faces[i]);
  else pair_edge(near_edges[i]);
}
