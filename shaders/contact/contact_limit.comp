// contact_limit: no pair crosses. Every candidate was apart at the substep's start, by planes across its normal; this pass finds
// for each particle the fraction of its way, from x to p, that it may go so that planes across the same normal still part all
// pairs at the end (the "divide and truncate" of Chen et al. 2025, "Offset geometric contact", with the division where it is
// needed). All particles go straight and evenly, so that the least height of a side above a plane between them is a concave
// function of time: sides apart at both ends are apart all the way.
//
//     side A   h >= gap/2     ----o----           h: height over the middle, towards the own side (m), so that both sides
//     middle - - - - - - - - - - - - - - -        are treated alike
//     side B   h >= gap/2     ----o----           way: change of h over the whole way (m)
//
// What goes along with its neighbours is not held back: only pairs that would end closer than a margin are, and of those
// only a side that comes nearer. That may bring the next pair into trouble, hence rounds: each takes the fractions of the
// rounds before it for granted and lowers its own, so that the order of threads does not matter. The last looks whether those
// were enough, and gives every particle the fraction that keeps it on its side of a plane that its pair does not move at
// all; settle uses that one if some pair was not safe.
//
// Particles of inverse mass 0, anchors and corners of meshes, come first: what they leave of the room belongs to the other side.
// Where cloth does not get out of their way in time they stop too, and go on in the next substep; but never further from their target
// than some distances that the pair keeps: from there on they are driven through whatever does not give way, which is held where it is.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

GATHER(positions)
GATHER(predicted)
GATHER_UINT4(candidates)
GATHER(contact_normals)
GATHER_UINT(contact_list)
READ_WRITE(uvec4, fractions)
READ_WRITE(Detection, detection)

#include "contact/contact.glsl"

const uint kLastRound = WEFT_ROUNDS - 1;
// Of a gap that may not shrink: so little is no motion.
const float kNothing = 1e-4;

float largest(vec3 v) { return max(abs(v.x), max(abs(v.y), abs(v.z))); }

// Of what particle i may go by the rounds before this one.
float fraction_before(uint i, uint round) {
  uint least = 0x3f800000u;   // 1.0; positive floats are ordered like their bits
  for (uint r = 0; r < round; ++r) least = min(least, fractions[WEFT_ROUNDS / 4 * i + r / 4][r % 4]);
  return uintBitsToFloat(least);
}

struct Sides {
  bool edges;
  bvec4 led;         // of inverse mass 0
  vec4 least;        // of its way that each must go: 0 unless it is led, and far from its target
  vec4 height, way;  // m
  float margin;      // m, to which sides that would cross are parted
  float noise;       // m, what rounding can do to a height
  float least_gap;   // m, below which they count as crossing
};

// Where settle would find a prediction not finite, it lets the particle stay.
vec3 way_of(vec3 x, vec3 p) { return dot(p, p) < 1e20 ? p - x : vec3(0); }

Sides sides_of(Candidate pair, vec3 n) {
  const mat4 x = mat4(FETCH(positions, pair.particle[0]), FETCH(positions, pair.particle[1]), FETCH(positions, pair.particle[2]),
                      FETCH(positions, pair.particle[3]));
  const mat4x3 ways = mat4x3(way_of(x[0].xyz, FETCH(predicted, pair.particle[0]).xyz), way_of(x[1].xyz, FETCH(predicted, pair.particle[1]).xyz),
                             way_of(x[2].xyz, FETCH(predicted, pair.particle[2]).xyz), way_of(x[3].xyz, FETCH(predicted, pair.particle[3]).xyz));
  const vec4 towards = signs(pair.edges);
  Sides sides;
  sides.edges = pair.edges;
  sides.led = equal(vec4(x[0].w, x[1].w, x[2].w, x[3].w), vec4(0));
  const vec4 lengths = vec4(length(ways[0]), length(ways[1]), length(ways[2]), length(ways[3]));
  sides.least = mix(vec4(0), max(vec4(0), 1 - contact_settings.patience * pair.keep / max(lengths, vec4(1e-30))), sides.led);
  sides.way = towards * (n * ways);
  const vec4 height = towards * (n * mat4x3(vec3(0), x[1].xyz - x[0].xyz, x[2].xyz - x[0].xyz, x[3].xyz - x[0].xyz));
  const vec2 least = least_of_sides(height, pair.edges);
  const float gap = least.x + least.y;
  sides.height = height + towards * (0.5 * (least.y - least.x));   // of both sides the least is now half the gap
  float size = 0;
  for (int j = 0; j < 4; ++j) size = max(size, max(largest(x[j].xyz), largest(x[j].xyz + ways[j])));
  sides.margin = clamp(gap, 0, max(kMargin * pair.keep, kFloor * size));
  sides.noise = 0.25 * kFloor * size;
  // Parted to the margin, they are apart whatever rounding does to it: that calls for no further round.
  sides.least_gap = sides.margin - (gap > sides.margin + sides.noise ? sides.noise : kNothing * sides.margin);
  return sides;
}

// How much lower than half the gap each side ends, if it advances at all (m).
vec2 advance(Sides sides, vec4 end) {
  return max(vec2(0), least_of_sides(sides.height, sides.edges) - least_of_sides(end, sides.edges));
}

// What those that are led take of the room if they go these fractions of their ways (m).
vec2 advance_of_led(Sides sides, vec4 fractions) { return advance(sides, mix(vec4(1e30), sides.height + fractions * sides.way, sides.led)); }

// A's share of the room, so that each side has what it needs: B first, if there is not enough for both.
float with_needs(float share, vec2 needs, float room) { return min(max(share, needs.x), room - needs.y); }

// The heights below which neither side may end, if they divide the free room like that: side A's part and all parts. Without
// room nobody advances, nor slips by rounding.
vec2 divided(Sides sides, float part, float parts) {
  const vec2 half_gap = least_of_sides(sides.height, sides.edges);
  const float room = half_gap.x + half_gap.y - sides.margin;
  if (room <= 0) return vec2(0.5 * sides.margin);
  const float wanted = with_needs(parts > 0 ? room * (part / parts) : 0.5 * room, advance_of_led(sides, vec4(1)), room);
  const float share = with_needs(wanted, advance_of_led(sides, sides.least), room);
  return half_gap - vec2(share, room - share);
}

// The least heights at the end. Who comes nearer alone may follow the other side up to the margin; who does not is only kept
// from slipping, by rounding, below half of it.
vec2 least_heights(Sides sides, vec4 end) {
  const vec2 nearer = advance(sides, end);
  if (nearer.x > 0 == nearer.y > 0) return divided(sides, nearer.x, nearer.x + nearer.y);
  const vec2 least = least_of_sides(end, sides.edges);
  const float slip = 0.5 * sides.margin;
  return nearer.x > 0 ? vec2(sides.margin - least.y, slip) : vec2(slip, sides.margin - least.x);
}

// The fractions with which all particles end at these heights at least, as far as they may stop.
vec4 fractions_to(Sides sides, vec2 least) {
  const vec4 bound = sides.edges ? least.xxyy : least.xyyy;
  const vec4 stopped = clamp((sides.height - bound) / max(-sides.way, vec4(1e-30)), sides.least, vec4(1));
  const bvec4 beyond = lessThan(sides.height + sides.way, bound), comes = lessThan(sides.way, vec4(sides.noise));
  vec4 t = vec4(1);
  for (int j = 0; j < 4; ++j) t[j] = beyond[j] && comes[j] ? stopped[j] : 1;
  return t;
}

void lower(Candidate pair, uint round, vec4 t, vec4 before) {
  for (int j = 0; j < 4; ++j)
    if (t[j] < before[j]) atomicMin(fractions[WEFT_ROUNDS / 4 * pair.particle[j] + round / 4][round % 4], floatBitsToUint(t[j]));
  if (round < kLastRound && any(lessThan(t, before))) atomicOr(detection[0].lowered[round], 1);
}

// Sides that meet have no planes between them: they stay.
void hold(Candidate pair) {
  vec4 t = vec4(1);
  for (int j = 0; j < 4; ++j)
    if (FETCH(positions, pair.particle[j]).w > 0) t[j] = 0;
  lower(pair, 0, t, vec4(1));
}

void limit(Candidate pair, vec3 n, uint round) {
  vec4 before;
  for (int j = 0; j < 4; ++j) before[j] = fraction_before(pair.particle[j], round);
  // Nothing has changed for this pair since the first round.
  if (round > 0 && round < kLastRound && before == vec4(1)) return;
  const Sides sides = sides_of(pair, n);
  const vec4 end = sides.height + before * sides.way;
  const vec2 least = least_of_sides(end, sides.edges);
  const bool crosses = least.x + least.y < sides.least_gap;
  if (round < kLastRound) {
    if (crosses) lower(pair, round, fractions_to(sides, least_heights(sides, end)), before);
    return;
  }
  const vec4 alone = fractions_to(sides, divided(sides, 0, 0));
  // Where these help nothing either, the others need not stop for it.
  if (crosses && any(lessThan(alone, before))) atomicOr(detection[0].unsafe, 1);
  lower(pair, round, alone, vec4(1));
}

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= detection[0].listings[WEFT_OPEN]) return;
  const uint round = (push.flags >> WEFT_ROUND_SHIFT) & kLastRound;
  if (round > 0 && detection[0].lowered[round - 1] == 0) return;
  const uint i = FETCH_UINT(contact_list, place);
  const vec3 n = FETCH(contact_normals, i).xyz;
  const Candidate pair = unpack_candidate(FETCH(candidates, i));
  if (n != vec3(0)) limit(pair, n, round);
  else if (round == 0) hold(pair);
}
