// outline_particles: by now it is known who is pushed, so every particle's displacement bound is complete; and which clusters are smooth,
// so that lists of near ones are put in order. And empties the set of tangled pairs, where the search is to fill it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT(memberships)
GATHER_UINT(cluster_pushes)
READ_WRITE(Detection, detection)
GATHER(detected_positions)
GATHER_WRITE(trajectories)
WRITE(uint, displacement_bounds)
GATHER_UINT(smooth_clusters)
READ_WRITE(uint, near_clusters)
WRITE(uvec4, near_boxes)
GATHER(cluster_boxes)
WRITE(uint, tangled_pairs)

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
#include "contact/final_track.glsl"
#include "contact/outline_particle.glsl"
#include "contact/order_near.glsl"

// push.count: particles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  outline_particle(i);
  for (uint k = i; k < contact_settings.clusters; k += push.count) put_in_order(k);
  if (untangles && detection[0].looks != 0)
    for (uint k = i; k < contact_settings.tangled_room; k += push.count) tangled_pairs[k] = 0;
}
