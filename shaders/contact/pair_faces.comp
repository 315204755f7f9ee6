// pair_faces: narrow phase. Of the near particles and triangles, those that may meet before the next detection (pair.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
GATHER_UINT4(cluster_faces)
READ(uvec2, near_faces)

#include "contact/narrow.glsl"

#include "contact/pair_faces.glsl"

// push.count: places in near_faces.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < min(push.count, detection[0].near[of_triangles])) pair_face(near_faces[i]);
}
