// detect_trajectory: gives every particle its predicted trajectory, a straight one, and a displacement bound about it; every cluster its
// box, and every triangle and edge its outline, about their particles' trajectories.
//
// While every particle stays within its bound, two primitives approach each other by no more than their trajectories and both bounds allow
// (pair.glsl). Only pairs that could meet under these limits become candidates, and a detection serves for many substeps. Where a
// particle is about to leave its bound the next substep begins with a detection; until then it is stopped at the bound if need be. So no
// contact is missed, whatever the motion.
//
// A trajectory is the coming substep's step times the candidate lifetime (detect_arguments): the longer, the more pairs can meet on it. It
// is no longer than 32 cells a substep, so that boxes stay bounded. A particle that is faster leaves its bound, and there is a detection
// in every substep.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(clusters)
GATHER_UINT(cluster_hulls)
GATHER_UINT4(cluster_faces)
GATHER_UINT4(cluster_edges)
READ(Detection, detection)
WRITE(vec4, detected_positions)
WRITE(vec4, trajectories)
WRITE(uint, displacement_bounds)
WRITE(vec4, cluster_boxes)
WRITE(uint, near_clusters)
WRITE(vec4, outlines)

#include "contact/grid.glsl"
#include "contact/cluster.glsl"
#include "contact/outline.glsl"

const float most_cells = 32;   // a substep

vec3 trajectory_along(vec3 d) {
  const float longest = most_cells * contact_settings.cell;
  const float squared = dot(d, d);
  if (!(squared < 1e20)) return vec3(0);   // not finite: it will be put back (update_velocity.glsl)
  return (squared > longest * longest ? longest / sqrt(squared) : 1) * float(detection[0].lifetime) * d;
}

Track track_of(uint i) {
  const vec3 x = FETCH(positions, i).xyz;
  return Track(x, trajectory_along(FETCH(predicted, i).xyz - x));
}

void start_particle(uint i) {
  const Track track = track_of(i);
  detected_positions[i] = vec4(track.at, 0);
  trajectories[i] = vec4(track.trajectory, 0);
  displacement_bounds[i] = floatBitsToUint(detection[0].margin);
}

void box_cluster(uint cluster) {
  Box box = Box(vec3(1e30), vec3(-1e30));
  const uint end = FETCH(clusters, cluster + 1).z;
  for (uint k = FETCH(clusters, cluster).z; k < end; ++k) {
    const uint i = FETCH_UINT(cluster_hulls, k);
    const Sweep sweep = sweep_of(track_of(i), FETCH(rest, i).w);
    box = Box(min(box.low, sweep.low), max(box.high, sweep.high));
  }
  cluster_boxes[2 * cluster] = vec4(box.low, 0);
  cluster_boxes[2 * cluster + 1] = vec4(box.high, 0);
  near_clusters[(WEFT_NEAR_CLUSTERS + 1) * cluster] = 0;   // its list begins empty (grid_search)
}

Outline outline_of_edge(uvec2 e) {
  const Track a = track_of(e.x), b = track_of(e.y);
  return Outline(0.5 * (a.at + b.at), 0.5 * (b.at - a.at), 0.5 * (a.trajectory + b.trajectory),
                 reach_of(0.5 * distance(a.trajectory, b.trajectory), sweep_of(a, b, FETCH(rest, e.x).w), FETCH(rest, e.x).w));
}

Outline outline_of_face(uvec3 t) {
  const Track a = track_of(t.x), b = track_of(t.y), c = track_of(t.z);
  const vec3 low = min(min(a.at, b.at), c.at), high = max(max(a.at, b.at), c.at);
  const vec3 trajectory = (a.trajectory + b.trajectory + c.trajectory) / 3;
  const float strays = max(max(distance(a.trajectory, trajectory), distance(b.trajectory, trajectory)), distance(c.trajectory, trajectory));
  const float thickness = FETCH(rest, t.x).w;
  return Outline(0.5 * (low + high), 0.5 * (high - low), trajectory, reach_of(strays, sweep_of(a, b, c, thickness), thickness));
}

// push.count: particles, clusters, triangles and edges, in this order.
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  if (i < contact_settings.particles) {
    start_particle(i);
    return;
  }
  i -= contact_settings.particles;
  if (i < contact_settings.clusters) {
    box_cluster(i);
    return;
  }
  i -= contact_settings.clusters;
  Outline outline;
  if (i < contact_settings.triangles) outline = outline_of_face(FETCH(cluster_faces, i).xyz);
  else outline = outline_of_edge(FETCH(cluster_edges, i - contact_settings.triangles).xy);
  outlines[3 * i] = vec4(outline.middle, outline.reach);
  outlines[3 * i + 1] = vec4(outline.half_sides, 0);
  outlines[3 * i + 2] = vec4(outline.trajectory, 0);
}
