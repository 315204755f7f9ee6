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
// Stages, for one candidate in one pass (1 and 3 in sides.glsl):
//   1. measure    (sides_of)          heights, displacements, margin, and which particles are kinematic
//   2. test       (limit_pair)        does the pair violate (1) with the fractions of the passes before? If not, it is left alone.
//   3. divide     (stopping_heights)  the slack, gap - margin, is divided between the sides in proportion to how much each approaches. A
//                                     side that approaches alone may follow the other one, which moves away, up to the margin.
//                 (share_with_kinematic)   kinematic particles are served first (below).
//   4. truncate   (truncated_fractions)    the time of impact of each particle with the plane at its stopping height
//   5. store      (lower_fractions)   atomicMin into this pass's entry of the particle
// What moves along with its neighbours satisfies (1) and is not slowed down. A fraction cuts the motion along the plane short as well:
// contact_slide has turned most steps along their planes before.
//
// Passes. A particle that is stopped may be in the way of its next neighbour, so stages 2 to 5 are repeated. A pass reads only fractions
// of the passes before it and writes only its own, so that the order of threads does not matter. The last pass tests whether those were
// enough, and computes the fallback: fractions by a plane that does not move, in the middle of the slack. A side that keeps to it satisfies
// its half of (1) whatever the other does. contact_finalize applies the fallback to all particles if a pair still violates (1).
//
// Kinematic particles (inverse mass 0: anchors, corners of collider meshes) come first: the other side gets the slack that they leave.
// Where cloth cannot give way in time they stop too, and go on in the next substep, but never further from their target than the kinematic
// lag limit. From there on they move on through whatever does not give way, and that is held in place.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER_UINT(contact_list)
READ_WRITE(uvec4, step_fractions)
READ_WRITE(Detection, detection)

#include "contact/contact.glsl"
#include "contact/sides.glsl"

const uint kLastPass = WEFT_LIMIT_PASSES - 1;
// The step fraction of particle i after the passes before this one.
float fraction_before(uint i, uint pass) {
  uint least = 0x3f800000u;   // 1.0; positive floats are ordered like their bits
  for (uint r = 0; r < pass; ++r) least = min(least, step_fractions[i][r]);
  return uintBitsToFloat(least);
}

// Stage 4: the step fractions at which particles reach the planes at these heights, their times of impact; 1 for those that do not.
// Kinematic particles take at least the fraction that they must.
vec4 truncated_fractions(Sides sides, vec2 stopping) {
  const vec4 bound = sides.edges ? stopping.xxyy : stopping.xyyy;
  const vec4 impact = clamp((sides.height - bound) / max(-sides.displacement, vec4(1e-30)), sides.least_fraction, vec4(1));
  const bvec4 ends_beyond = lessThan(sides.height + sides.displacement, bound);
  const bvec4 approaches = lessThan(sides.displacement, vec4(sides.rounding_error));
  vec4 t = vec4(1);
  for (int j = 0; j < 4; ++j) t[j] = ends_beyond[j] && approaches[j] ? impact[j] : 1;
  return t;
}

// Stage 5.
void lower_fractions(Candidate pair, uint pass, vec4 t, vec4 before) {
  for (int j = 0; j < 4; ++j)
    if (t[j] < before[j]) atomicMin(step_fractions[pair.particle[j]][pass], floatBitsToUint(t[j]));
  if (pass < kLastPass && any(lessThan(t, before))) atomicOr(detection[0].changed[pass], 1);
}

// Sides that touch or overlap at the start have no normal, hence no planes: their particles stay, except kinematic ones.
void hold_in_place(Candidate pair) {
  vec4 t = vec4(1);
  for (int j = 0; j < 4; ++j)
    if (FETCH(positions, pair.particle[j]).w > 0) t[j] = 0;
  lower_fractions(pair, 0, t, vec4(1));
}

void limit_pair(Candidate pair, vec3 n, uint pass) {
  vec4 before;
  for (int j = 0; j < 4; ++j) before[j] = fraction_before(pair.particle[j], pass);
  // Nothing has changed for this pair since the first pass.
  if (pass > 0 && pass < kLastPass && before == vec4(1)) return;
  const Sides sides = sides_of(pair, n);
  const vec4 end = sides.height + before * sides.displacement;
  const vec2 least = least_of_sides(end, sides.edges);
  const bool crosses = least.x + least.y < sides.least_gap;
  if (pass < kLastPass) {
    if (crosses) lower_fractions(pair, pass, truncated_fractions(sides, stopping_heights(sides, end)), before);
    return;
  }
  const vec4 fallback = truncated_fractions(sides, divide_slack(sides, 0, 0));
  // A pair that crosses calls for the fallback, unless that would change nothing for it: then the others need not stop on its account.
  if (crosses && any(lessThan(fallback, before))) atomicOr(detection[0].falls_back, 1);
  lower_fractions(pair, pass, fallback, vec4(1));
}

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= detection[0].listings[WEFT_UNSAFE]) return;
  const uint pass = (push.flags >> WEFT_PASS_SHIFT) & kLastPass;
  if (pass > 0 && detection[0].changed[pass - 1] == 0) return;
  const uint i = FETCH_UINT(contact_list, place);
  const vec3 n = FETCH(contact_normals, i).xyz;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  if (n != vec3(0)) limit_pair(pair, n, pass);
  else if (pass == 0) hold_in_place(pair);
}
