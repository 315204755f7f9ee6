// outline_faces: gives every triangle its outline, and the box of that.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT4(cluster_faces)
GATHER_UINT(memberships)
GATHER_UINT(cluster_pushes)
READ(Detection, detection)
GATHER(detected_positions)
GATHER(trajectories)
WRITE(vec4, outlines)
WRITE(uvec4, outline_boxes)
GATHER(cluster_boxes)

#include "contact/apart.glsl"
#include "contact/grid.glsl"
#include "contact/predicted_track.glsl"
#include "contact/outline.glsl"
#include "contact/cluster.glsl"
#include "contact/latest_box.glsl"
#include "contact/outline_box.glsl"
#include "contact/final_track.glsl"
#include "contact/put_outline.glsl"
#include "contact/outline_face.glsl"

// push.count: triangles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < push.count) outline_face(i);
}
