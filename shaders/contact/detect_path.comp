// detect_path: gives every particle the straight path that it is on, and a leash about it.
//
// While every particle stays on its leash, two primitives come closer by no more than their paths do and both leashes allow
// (pair.glsl), so that only pairs which these bounds let meet are candidates, and a search holds for many substeps. A
// particle that wants to leave its leash makes the next substep begin with a detection, and until then is stopped on its
// way if need be: nothing is lost, whatever the motion.
//
// A path is the coming substep's way, as many times as searches have been holding lately: the longer, the more pairs can meet on it. It is no longer than 32 cells a substep, so that boxes stay bounded;
// what is faster leaves its leash, and there is a detection in every substep.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
READ(Detection, detection)
WRITE(vec4, references)
WRITE(vec4, paths)
WRITE(uint, leashes)

const float most_cells = 32;   // a substep

vec3 path_along(vec3 d) {
  const float longest = most_cells * contact_settings.cell;
  const float squared = dot(d, d);
  if (!(squared < 1e20)) return vec3(0);   // lost: it will be put back (update_velocity.glsl)
  return (squared > longest * longest ? longest / sqrt(squared) : 1) * float(detection[0].horizon) * d;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const vec3 x = FETCH(positions, i).xyz;
  references[i] = vec4(x, 0);
  paths[i] = vec4(path_along(FETCH(predicted, i).xyz - x), 0);
  leashes[i] = floatBitsToUint(detection[0].reach);
}
