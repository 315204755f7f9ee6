// contact_solve: one Jacobi iteration over the active contacts that penetrate, XPBD with zero compliance and Coulomb friction: C = n . sum w_j p_j -
// separation >= 0 at the current iterate.
//
// Masses are split by penetration (contact_share.glsl): a contact sees its particle j with the share s_j of its mass, so
// lambda = -C / sum W_j w_j^2 / s_j, dp_j = W_j w_j lambda n. Coulomb friction takes back the tangential motion u of the pair since the
// substep's start, by an impulse of at most mu lambda and of no more than stops u.
//
// Bounded lever: where only a particle with a small weight w_j can move, lambda would be large and throw it away. So the divisor is no less
// than the largest W_j w_j, and no particle is moved further than the penetration. All particles of a contact get the same impulse, and
// their weights sum to 0: momentum is conserved.
//
// Corrections are summed as integers, in units of a quantum, so that the sum does not depend on the order of threads.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER(contact_weights)
GATHER_UINT(contact_counts)
GATHER_UINT(contact_list)
READ(Detection, detection)
GATHER(velocities)
GATHER(materials)
GATHER_UINT(contact_penetrations)
READ_WRITE(ivec4, contact_sums)
READ(Collider, colliders)
#define PENETRATIONS(i) FETCH_UINT(contact_penetrations, i)

#include "contact/list_places.glsl"
#include "contact/wide.glsl"
#include "contact/contact.glsl"
#include "contact/contact_share.glsl"
#include "reaction/quanta.glsl"
#include "reaction/touched_mesh.glsl"
#include "reaction/mesh.glsl"
#include "contact/solve.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place < detection[0].listings[WEFT_PENETRATING]) solve_contact(LISTED(WEFT_PENETRATING, place));
}
