// narrow: pair.glsl and what it needs, for the passes that are the narrow phase and nothing else.

#include "contact/track.glsl"

GATHER(positions)
GATHER(velocities)
GATHER(materials)
#include "motion/body.glsl"

WRITE(uvec4, candidates)
GATHER_WRITE_UINT(displacement_bounds)
READ_WRITE(Counters, counters)
#include "contact/candidate.glsl"

#include "contact/pair.glsl"
