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

#include "contact/apart.glsl"
#include "contact/grid.glsl"
#include "contact/start_track.glsl"

// push.count: particles.
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < push.count) start_track(i);
}
