// contact_limit: conservative advancement. Finds for every particle the fraction t of its step from x to p that it may take so that no
// candidate pair crosses. Planar divide and truncate, after Chen et al. 2025, "Offset geometric contact": a plane in the gap of each pair
// divides the gap between the two sides, and a step that would pass its plane is truncated there.
//
// Derivation. contact_prepare has found for each pair a normal n with a positive gap between the sides at the substep's start. Heights
// are measured along n from the middle of this gap, each side's towards itself, so that both sides obey the same formulas:
//
//     side A   h >= gap/2     ----o----           h_j(s) = h_j + s t_j d_j   at the time s of the substep, 0 <= s <= 1,
//     middle - - - - - - - - - - - - - - -        d_j: change of the height over the whole step (m)
//     side B   h >= gap/2     ----o----           t_j: the particle's step fraction
//
// Steps are straight and even, so each h_j(s) is linear, the least height of a side is concave in s, and so is the sum of both sides'
// least heights. A concave function that is positive at s = 0 and at s = 1 is positive in between: planes across n that part the sides at
// both ends part them all the way. It is therefore enough to choose the t_j so that
//     min over A (h_j + t_j d_j) + min over B (h_j + t_j d_j) >= margin.                                                            (1)
//
// Stages, for one candidate in one round (1 and 3 in sides.glsl, the others in limit.glsl):
//   1. measure    (sides_of)          heights, displacements, margin, and which particles are kinematic
//   2. test       (limit_pair)        does the pair violate (1) with the fractions of the round before? If not, it is left alone.
//                 (parting_normal)  Any normal with a gap at the start will do for (1): a better one is tried first.
//   3. divide     (stopping_heights)  the slack, gap - margin, is divided between the sides in proportion to how much each approaches. A
//                                     side that approaches alone may follow the other one, which moves away, up to the margin.
//                 (share_with_kinematic)   kinematic particles are served first (below).
//   4. truncate   (truncated_fractions)    the time of impact of each particle with the plane at its stopping height
//   5. store      (lower_fractions)   atomicMin into this round's entry of the particle
// What moves along with its neighbours satisfies (1) and is not slowed down. A fraction cuts the motion along the plane short as well:
// contact_slide has turned most steps along their planes before.
//
// Rounds. A particle that is stopped may be in the way of its next neighbour, so stages 2 to 5 are repeated until nothing changes: the first
// rounds here, where every pair is looked at by a thread of its own, all others in one workgroup (contact_limit_rest), as they concern the
// neighbours of those that were stopped. A round reads only the fractions of the round before and writes only its own, so that the order
// of threads does not matter. After half of WEFT_LIMIT_ROUNDS pairs take a plane that does not move, in the middle of the slack. A side that
// keeps to it satisfies its half of (1) whatever the other does: a pair asks for it once a normal, so that there is an end to rounds. If
// it is not reached in time, all particles take the fraction by such planes, the fallback (contact_finalize).
//
// Kinematic particles (inverse mass 0: anchors, corners of collider meshes) come first: the other side gets the slack that they leave.
// Where cloth cannot give way in time they stop too, and go on in the next substep: one that began a substep further from its target than the
// kinematic lag limit takes at least the excess. From there on they move on through whatever does not give way, and that is held in place.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER_UINT(contact_list)
READ_WRITE(uvec4, step_fractions)
READ_WRITE(ivec4, contact_sums)
GATHER(velocities)
GATHER(materials)
READ_WRITE(Detection, detection)

#include "contact/list_places.glsl"
#include "contact/wide.glsl"
#include "contact/contact.glsl"
#include "contact/proximity.glsl"
#include "contact/sides.glsl"
#include "reaction/touched_mesh.glsl"
#include "contact/parting.glsl"
#include "contact/limit.glsl"

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= detection[0].listings[WEFT_UNSAFE]) return;
  const uint round = (push.flags >> WEFT_PASS_SHIFT) & 15u;
  if (round == 0 || detection[0].changed[round - 1] != 0) limit(LISTED(WEFT_UNSAFE, place), round);
}
