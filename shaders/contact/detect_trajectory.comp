// detect_trajectory: gives every particle its predicted trajectory, a straight one, and a displacement bound about it, and every triangle and
// edge its outline, about its particles' trajectories.
//
// While every particle stays within its bound, two primitives approach each other by no more than their trajectories and both bounds allow
// (pair.glsl). Only pairs that could meet under these limits become candidates, and a detection serves for many substeps. Where a
// particle is about to leave its bound the next substep begins with a detection; until then it is stopped at the bound if need be. So no
// contact is missed, whatever the motion.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER_UINT4(cluster_faces)
GATHER_UINT4(cluster_edges)
GATHER_UINT(cluster_owners)
GATHER_UINT(cluster_pushes)
READ(Detection, detection)
WRITE(vec4, detected_positions)
WRITE(vec4, trajectories)
WRITE(uint, displacement_bounds)
WRITE(vec4, outlines)

#include "contact/grid.glsl"

float pushed(uint i) {
  return detection[0].most_pushed == 0 ? 0 : uintBitsToFloat(FETCH_UINT(cluster_pushes, FETCH_UINT(cluster_owners, i)));
}

#include "contact/predicted_track.glsl"
#include "contact/outline.glsl"

void start_particle(uint i) {
  const Track track = track_of(i);
  detected_positions[i] = vec4(track.at, 0);
  trajectories[i] = vec4(track.trajectory, track.bound);
  displacement_bounds[i] = floatBitsToUint(track.bound);
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

// push.count: particles, triangles and edges, in this order.
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  if (i < contact_settings.particles) {
    start_particle(i);
    return;
  }
  i -= contact_settings.particles;
  Outline outline;
  if (i < contact_settings.triangles) outline = outline_of_face(FETCH(cluster_faces, i).xyz);
  else outline = outline_of_edge(FETCH(cluster_edges, i - contact_settings.triangles).xy);
  outlines[3 * i] = vec4(outline.middle, outline.reach);
  outlines[3 * i + 1] = vec4(outline.half_sides, 0);
  outlines[3 * i + 2] = vec4(outline.trajectory, 0);
}
