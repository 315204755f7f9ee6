// contact_limit_rest: what contact_limit goes on with until nothing changes, in one workgroup that waits for itself: the rounds after its
// first ones, which are nearly always enough.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER_UINT(contact_list)
READ_WRITE(ivec4, contact_sums)
GATHER(velocities)
GATHER(materials)
SHARE(uvec4, step_fractions)
SHARE(Detection, detection)

#include "contact/list_places.glsl"
#include "contact/wide.glsl"
#include "contact/contact.glsl"
#include "contact/proximity.glsl"
#include "contact/sides.glsl"
#include "reaction/touched_mesh.glsl"
#include "contact/parting.glsl"
#include "contact/limit.glsl"
#include "wait.glsl"
#include "contact/limit_rest.glsl"

void main() { limit_from(gl_LocalInvocationID.x, WEFT_WIDE_ROUNDS); }
