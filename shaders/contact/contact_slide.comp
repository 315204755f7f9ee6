// contact_slide: turns the steps of sides that would cross along the planes that part them (contact_limit.comp), as far as particles can
// move. Jacobi iterations leave something of a penetration, and contact_limit stops a particle for it altogether: cloth under tension was
// held where it should slide, on a mesh collider's corner for ever. What is in a kinematic particle's way goes ahead of it.
//
// An end below its side's stopping height is raised to it along the normal. A particle takes of all that its pairs ask the largest, of each
// sign of each coordinate: pairs that ask for the same do not add up, and pairs that ask for different things all get them, unless they
// oppose each other. Positive floats are ordered like their bits, so that neither sums nor the order of threads matter.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER_UINT(contact_list)
READ(Detection, detection)
READ_WRITE(uvec4, slides)
READ_WRITE(ivec4, contact_sums)
GATHER(velocities)
GATHER(materials)

#include "contact/list_places.glsl"
#include "contact/wide.glsl"
#include "contact/contact.glsl"
#include "contact/sides.glsl"
#include "reaction/touched_mesh.glsl"
#include "contact/slide.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place < detection[0].listings[WEFT_ACTIVE]) ask_for_ways(LISTED(WEFT_ACTIVE, place));
}
