// detect_arguments: decides whether this substep begins with a detection, chooses how long displacement bounds may be, and writes the
// dispatch arguments of the detection's passes, which are empty without one; and empties the substep's lists. One thread.
//
// A particle's displacement bound follows its motion (detect_track), between the least bound and the margin. Large ones find more
// candidates, small ones ask for detections more often. The least grows while candidates are so few that they cost next to nothing, or
// while detections follow each other closely, and shrinks while candidates are many; then bounds are also meant for fewer substeps.
//
// Particles that moved fast had long trajectories, and many pairs could meet on them. Where all particles have stayed within their bounds
// for a whole lifetime and candidates are many, one more detection, a settled one, replaces them by the few of the present, slow motion.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

READ_WRITE(Detection, detection)
READ_WRITE(Counters, counters)

#include "contact/groups.glsl"
#include "contact/arguments.glsl"

void main() {
  if (gl_LocalInvocationID.x == 0) decide();
}
