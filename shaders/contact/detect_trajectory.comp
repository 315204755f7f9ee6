// detect_trajectory: gives every particle its predicted trajectory, a straight one, and a displacement bound about it.
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
READ(Detection, detection)
WRITE(vec4, detected_positions)
WRITE(vec4, trajectories)
WRITE(uint, displacement_bounds)

const float most_cells = 32;   // a substep

vec3 trajectory_along(vec3 d) {
  const float longest = most_cells * contact_settings.cell;
  const float squared = dot(d, d);
  if (!(squared < 1e20)) return vec3(0);   // not finite: it will be put back (update_velocity.glsl)
  return (squared > longest * longest ? longest / sqrt(squared) : 1) * float(detection[0].lifetime) * d;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec3 x = FETCH(positions, i).xyz;
  detected_positions[i] = vec4(x, 0);
  trajectories[i] = vec4(trajectory_along(FETCH(predicted, i).xyz - x), 0);
  displacement_bounds[i] = floatBitsToUint(detection[0].margin);
}
