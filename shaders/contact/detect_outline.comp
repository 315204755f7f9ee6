// detect_outline: outline_particles, outline_faces and outline_edges in one dispatch, on a GPU.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT4(cluster_faces)
GATHER_UINT4(cluster_edges)
GATHER_UINT(memberships)
GATHER_UINT(cluster_pushes)
READ_WRITE(Detection, detection)
GATHER(detected_positions)
GATHER_WRITE(trajectories)
WRITE(uint, displacement_bounds)
GATHER_UINT(smooth_clusters)
READ_WRITE(uint, near_clusters)
WRITE(uvec4, near_boxes)
WRITE(vec4, outlines)
WRITE(uvec4, outline_boxes)
WRITE(uint, tangled_pairs)
GATHER(cluster_boxes)

#include "contact/apart.glsl"
#include "contact/grid.glsl"
#include "contact/groups.glsl"
#include "contact/rare.glsl"

#include "contact/predicted_track.glsl"
#include "contact/outline.glsl"
#include "contact/cluster.glsl"
#include "contact/latest_box.glsl"
#include "contact/outline_box.glsl"
#include "contact/near_list.glsl"
#include "contact/outline_either.glsl"

// push.count: particles, triangles, edges and clusters, in this order.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  outline_either(i);
  if (untangles && detection[0].looks != 0)   // the search fills them
    for (uint k = i; k < contact_settings.tangled_room; k += push.count) tangled_pairs[k] = 0;
}
