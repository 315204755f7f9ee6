// detect_track: gives every particle its predicted trajectory, a straight one, and a displacement bound about it.
//
// While every particle stays within its bound, two primitives approach each other by no more than their trajectories and both bounds allow
// (pair.glsl). Only pairs that could meet under these limits become candidates, and a detection serves for many substeps. Where a
// particle is about to leave its bound the next substep begins with a detection; until then it is stopped at the bound if need be. So no
// contact is missed, whatever the motion.
//
// A trajectory is the coming substep's step times the candidate lifetime (detect_arguments): the longer, the more pairs can meet on it. It
// is no longer than 32 cells a substep, so that boxes stay bounded. A particle that is faster leaves its bound, and there is a detection
// in every substep.
//
// A large bound makes candidates of pairs that never meet, a small one asks for detections; and cloth is calm in one place while it whirls
// in another. So every particle's bound follows from how far it has come off its last trajectory: under a constant acceleration a that is
// a h^2 n (n + 1) / 2 after n substeps of symplectic Euler.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_WRITE(detected_positions)
GATHER_WRITE(trajectories)
GATHER_UINT(near_bounds)
READ(Detection, detection)

#include "contact/grid.glsl"

const float most_cells = 32;   // a substep

// How much larger a bound is than the last motion asks for, as the next is another; what a calmer particle keeps of its last bound; and
// what it takes over from its cluster, as waves run.
// Measured (drop of 100 x 100) without the last: 1.25 and 0.7 need twice the detections, 2 and 0.95 twice the candidates.
const float spare = 1.6, kept = 0.85, spread = 0.5;

vec3 trajectory_along(vec3 d) {
  const float longest = most_cells * contact_settings.cell;
  const float squared = dot(d, d);
  if (!(squared < 1e20)) return vec3(0);   // not finite: it will be put back (update_velocity.glsl)
  return (squared > longest * longest ? longest / sqrt(squared) : 1) * float(detection[0].lifetime) * d;
}

float sum_to(uint n) { return 0.5 * float(n * (n + 1)); }

// p: where the particle is about to go.
float bound_of(uint i, vec3 p) {
  const float most = detection[0].margin;
  const uint passed = detection[0].served + 1, lifetime = detection[0].served_lifetime;
  const vec4 at = FETCH(detected_positions, i);
  if (lifetime == 0) return clamp(at.w, detection[0].least, most);   // the first detection, or the first after the host has put particles
  const vec3 expected = at.xyz + float(min(passed, lifetime)) / float(lifetime) * FETCH(trajectories, i).xyz;
  const float own = spare * distance(p, expected) * (sum_to(detection[0].horizon) / sum_to(passed));
  const float near = spread * uintBitsToFloat(FETCH_UINT(near_bounds, i));
  return own < most ? clamp(max(own, max(kept * at.w, near)), detection[0].least, most) : most;
}

// push.count: particles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec3 x = FETCH(positions, i).xyz, p = FETCH(predicted, i).xyz;
  const float bound = bound_of(i, p);
  detected_positions[i] = vec4(x, bound);
  trajectories[i].xyz = trajectory_along(p - x);
}
