// detect_alone: a detection as far as its search, in one workgroup that waits for itself, where detections are seldom: it is a single dispatch
// instead of six, which are empty in most substeps. What it does is to the bit what those passes do, so that the host may choose by what it
// knows of earlier frames (FrameInput::seldom_detections): the order of lists is the only difference, and nothing depends on it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT(cluster_hulls)
GATHER_UINT(memberships)
GATHER_UINT4(cluster_edges)
READ_WRITE(Counters, counters)
WRITE(uint, displacement_bounds)
WRITE(vec4, outlines)
WRITE(uvec4, outline_boxes)
WRITE(uvec4, near_boxes)
WRITE(uint, tangled_pairs)
// This dispatch has written what it reads of these.
SHARE(Detection, detection)
SHARE(vec4, detected_positions)
SHARE(vec4, trajectories)
SHARE(uint, near_bounds)
SHARE(vec4, cluster_boxes)
SHARE(vec4, cluster_motions)
SHARE(uint, cluster_pushes)
SHARE(uint, smooth_clusters)
SHARE(uint, near_clusters)
SHARE(uint, grid_counts)
SHARE(uint, grid_starts)
SHARE(vec4, grid_entries)
#define LATEST(name, i) name[i]
#define LATEST_UINT(name, i) name[i]

#include "wait.glsl"

#include "contact/groups.glsl"
#include "contact/rare.glsl"
#include "contact/grid.glsl"
#include "contact/cluster.glsl"
#include "contact/latest_box.glsl"
#include "contact/predicted_track.glsl"
#include "contact/scan.glsl"
#include "contact/smooth.glsl"
#include "contact/outline.glsl"
#include "contact/outline_box.glsl"
#include "contact/near_list.glsl"
#include "contact/arguments.glsl"
#include "contact/start_track.glsl"
#include "contact/make_box.glsl"
#include "contact/fill.glsl"
#include "contact/find_near.glsl"
#include "contact/outline_either.glsl"

void main() {
  const uint thread = gl_LocalInvocationID.x, particles = contact_settings.particles, clusters = contact_settings.clusters;
  if (thread == 0) decide();
  wait();
  if (detection[0].clusters.x == 0) return;   // none is due
  for (uint i = thread; i < particles; i += workgroup) start_track(i);
  wait();
  for (uint k = thread; k < clusters; k += workgroup) make_box(k);
  wait();
  fill(thread, clusters);
  wait();
  for (uint k = thread; k < clusters; k += workgroup) find_near(k);
  wait();
  const uint outlined = particles + contact_settings.triangles + contact_settings.edges + clusters;
  for (uint i = thread; i < outlined; i += workgroup) outline_either(i);
  if (untangles && detection[0].looks != 0)   // detect_search fills them
    for (uint k = thread; k < contact_settings.tangled_room; k += workgroup) tangled_pairs[k] = 0;
}
