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
// Stages, for one candidate in one pass:
//   1. measure    (sides_of)          heights, displacements, margin, and which particles are kinematic
//   2. test       (limit_pair)        does the pair violate (1) with the fractions of the passes before? If not, it is left alone.
//   3. divide     (stopping_heights)  the slack, gap - margin, is divided between the sides in proportion to how much each approaches. A
//                                     side that approaches alone may follow the other one, which moves away, up to the margin.
//                 (share_with_kinematic)   kinematic particles are served first (below).
//   4. truncate   (truncated_fractions)    the time of impact of each particle with the plane at its stopping height
//   5. store      (lower_fractions)   atomicMin into this pass's entry of the particle
// What moves along with its neighbours satisfies (1) and is not slowed down.
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

const uint kLastPass = WEFT_LIMIT_PASSES - 1;
// Of a gap that may not shrink: a change as small as this is no motion.
const float kNegligible = 1e-4;

float largest(vec3 v) { return max(abs(v.x), max(abs(v.y), abs(v.z))); }

// The step fraction of particle i after the passes before this one.
float fraction_before(uint i, uint pass) {
  uint least = 0x3f800000u;   // 1.0; positive floats are ordered like their bits
  for (uint r = 0; r < pass; ++r) least = min(least, step_fractions[WEFT_LIMIT_PASSES / 4 * i + r / 4][r % 4]);
  return uintBitsToFloat(least);
}

// A pair seen along its normal; vec4s have one value for each of its particles.
struct Sides {
  bool edges;
  bvec4 kinematic;       // of inverse mass 0
  vec4 least_fraction;   // of its step that each must take: 0 unless it is kinematic and far from its target
  vec4 height;           // m, at the substep's start: h in the drawing
  vec4 displacement;     // m, change of the height over the whole step: d
  float margin;          // m, to which sides that would cross are parted
  float rounding_error;  // m, of a height, at most
  float least_gap;       // m, below which the pair counts as crossing
};

// contact_finalize lets a particle stay whose prediction is not finite.
vec3 step_of(vec3 x, vec3 p) { return dot(p, p) < 1e20 ? p - x : vec3(0); }

// Stage 1.
Sides sides_of(Candidate pair, vec3 n) {
  const uint a = pair.particle[0], b = pair.particle[1], c = pair.particle[2], d = pair.particle[3];
  const mat4 x = mat4(FETCH(positions, a), FETCH(positions, b), FETCH(positions, c), FETCH(positions, d));
  const mat4x3 steps = mat4x3(step_of(x[0].xyz, FETCH(predicted, a).xyz), step_of(x[1].xyz, FETCH(predicted, b).xyz),
                              step_of(x[2].xyz, FETCH(predicted, c).xyz), step_of(x[3].xyz, FETCH(predicted, d).xyz));
  const vec4 towards = signs(pair.edges);
  Sides sides;
  sides.edges = pair.edges;
  sides.kinematic = equal(vec4(x[0].w, x[1].w, x[2].w, x[3].w), vec4(0));
  const vec4 lengths = vec4(length(steps[0]), length(steps[1]), length(steps[2]), length(steps[3]));
  const vec4 required = max(vec4(0), 1 - contact_settings.kinematic_lag_limit * pair.separation / max(lengths, vec4(1e-30)));
  sides.least_fraction = mix(vec4(0), required, sides.kinematic);
  sides.displacement = towards * (n * steps);
  const vec4 height = towards * (n * mat4x3(vec3(0), x[1].xyz - x[0].xyz, x[2].xyz - x[0].xyz, x[3].xyz - x[0].xyz));
  const vec2 least = least_of_sides(height, pair.edges);
  const float gap = least.x + least.y;
  sides.height = height + towards * (0.5 * (least.y - least.x));   // now the least height of either side is half the gap
  float size = 0;
  for (int j = 0; j < 4; ++j) size = max(size, max(largest(x[j].xyz), largest(x[j].xyz + steps[j])));
  sides.margin = clamp(gap, 0, max(kMargin * pair.separation, kFloor * size));
  sides.rounding_error = 0.25 * kFloor * size;
  // A pair that an earlier pass parted to the margin does not count as crossing, in spite of rounding: no further pass is needed for it.
  // A pair without slack may not come any closer.
  const float tolerance = gap > sides.margin + sides.rounding_error ? sides.rounding_error : kNegligible * sides.margin;
  sides.least_gap = sides.margin - tolerance;
  return sides;
}

// How much lower than half the gap the least height of each side is at the end, or 0 (m).
vec2 approach(Sides sides, vec4 end) {
  return max(vec2(0), least_of_sides(sides.height, sides.edges) - least_of_sides(end, sides.edges));
}

// The same for the kinematic particles alone, if they take these fractions of their steps: the slack that they need (m).
vec2 kinematic_approach(Sides sides, vec4 fractions) {
  return approach(sides, mix(vec4(1e30), sides.height + fractions * sides.displacement, sides.kinematic));
}

// Side A's share of the slack, changed so that each side gets the slack that it needs: side B first, if there is not enough for both.
float share_with_kinematic(float share, vec2 needs, float slack) { return min(max(share, needs.x), slack - needs.y); }

// The stopping heights if the slack is divided as part_a to parts - part_a; in halves if parts is 0. Kinematic particles get what they
// need to reach their targets, and before that what they need to stay within their lag limit. Without slack nobody approaches, not even
// by rounding.
vec2 divide_slack(Sides sides, float part_a, float parts) {
  const vec2 half_gap = least_of_sides(sides.height, sides.edges);
  const float slack = half_gap.x + half_gap.y - sides.margin;
  if (slack <= 0) return vec2(0.5 * sides.margin);
  const float proportional = parts > 0 ? slack * (part_a / parts) : 0.5 * slack;
  const float wanted = share_with_kinematic(proportional, kinematic_approach(sides, vec4(1)), slack);
  const float share = share_with_kinematic(wanted, kinematic_approach(sides, sides.least_fraction), slack);
  return half_gap - vec2(share, slack - share);
}

// Stage 3: the heights at which the planes stand, below which no particle of side A (x) or B (y) may end. If one side approaches alone,
// its plane follows the other side up to the margin; the other side's plane, at half the margin, only guards it against rounding.
vec2 stopping_heights(Sides sides, vec4 end) {
  const vec2 nearer = approach(sides, end);
  if (nearer.x > 0 == nearer.y > 0) return divide_slack(sides, nearer.x, nearer.x + nearer.y);
  const vec2 least = least_of_sides(end, sides.edges);
  const float guard = 0.5 * sides.margin;
  return nearer.x > 0 ? vec2(sides.margin - least.y, guard) : vec2(guard, sides.margin - least.x);
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
    if (t[j] < before[j]) atomicMin(step_fractions[WEFT_LIMIT_PASSES / 4 * pair.particle[j] + pass / 4][pass % 4], floatBitsToUint(t[j]));
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
